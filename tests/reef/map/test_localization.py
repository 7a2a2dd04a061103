import dataclasses
import math

import numpy as np
import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.map.localization import LocalizationCfg, Localizer
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.simulation.noise import SensorNoiseCfg
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

CAMERA = CameraCfg()
HERE = Pose(5.0, 5.0, 0.0)
DRIFTS = LocalizationCfg(drift_xy=0.06, drift_theta=0.006)


def camera(*posts):
    """Camera in a world of posts at (x, y), 0.2 m in radius."""
    bed = Cluster(name="bed", oysters=(Oyster(x=0.5, y=9.5, z=0.05, radii=(0.1, 0.1, 0.06), rpy=(0.0, 0.0, 0.0)),))
    obstacles = tuple(Obstacle(shape="cylinder", x=x, y=y, z=0.9, size=(0.2, 0.2, 0.9)) for x, y in posts)
    world = ReefWorld(
        name="test", size_m=(10.0, 10.0), start=Start(x=5.0, y=5.0, theta=0.0), clusters=(bed,), obstacles=obstacles
    )
    return Camera(Scene.from_world(world), CAMERA)


def settled(water, pose=HERE, ticks=20, cfg=DRIFTS):
    """Localizer that has stood at a pose with exact odometry for some ticks."""
    localizer = Localizer(CAMERA, cfg)
    for k in range(ticks):
        localizer.update(water.render(pose), pose, 0.1 if k else 0.0)
    return localizer


def shifted(pose, dx, dy, dtheta):
    return Pose(pose.x + dx, pose.y + dy, pose.theta + dtheta)


def test_exact_odometry_is_returned_as_it_is():
    localizer = Localizer(CAMERA)
    pose = Pose(1.0, 2.0, 3.0)
    assert localizer.update(camera((7.0, 5.0)).render(HERE), pose, 0.1) is pose
    assert not localizer.active


@pytest.mark.parametrize("error", [(0.3, -0.2, 0.05), (-0.4, 0.1, -0.08), (0.0, 0.0, 0.1)])
def test_posts_seen_again_give_the_error_of_the_odometry(error):
    water = camera((7.0, 5.4), (6.6, 3.9), (7.3, 6.4))
    localizer = settled(water, ticks=60)
    odometry = shifted(HERE, *error)
    localizer.update(water.render(HERE), odometry, 60.0)  # a minute in which nothing was looked at
    for _ in range(60):
        pose = localizer.update(water.render(HERE), odometry, 0.1)
    assert pose[:2] == pytest.approx(HERE[:2], abs=0.17)
    assert abs(pose.theta) <= 0.7 * abs(error[2])
    assert len(localizer.hypotheses[0].map.centres) == 3


def test_the_same_posts_are_found_from_elsewhere():
    water = camera((7.0, 5.4), (6.6, 3.9), (7.3, 6.4))
    localizer = settled(water)
    there = Pose(5.8, 5.6, -0.5)
    odometry = shifted(there, 0.25, 0.25, 0.05)
    for k in range(10):
        pose = localizer.update(water.render(there), odometry, 20.0 if k == 0 else 0.1)
    assert pose[:2] == pytest.approx(there[:2], abs=0.1)
    assert len(localizer.hypotheses[0].map.centres) == 3


def test_empty_water_gives_no_correction_and_the_doubt_grows_as_the_walk_does():
    water = camera()
    localizer = settled(water, ticks=1)
    odometry = shifted(HERE, 0.3, 0.1, 0.05)
    for _ in range(100):
        pose = localizer.update(water.render(HERE), odometry, 0.1)
    assert pose == pytest.approx(odometry)
    assert localizer.sigma == pytest.approx((0.06 * math.sqrt(10), 0.06 * math.sqrt(10), 0.006 * math.sqrt(10)))


def test_one_post_corrects_the_position_and_leaves_the_doubt_in_the_heading():
    water = camera((7.0, 5.0))
    localizer = settled(water)
    for k in range(20):
        pose = localizer.update(water.render(HERE), shifted(HERE, 0.3, 0.0, 0.0), 60.0 if k == 0 else 0.1)
    assert pose.x == pytest.approx(5.0, abs=0.1)
    x, y, theta = localizer.sigma
    assert max(x, y) < 0.5 * 0.06 * math.sqrt(60)
    assert theta > 0.9 * 0.006 * math.sqrt(60)


def test_a_wrong_match_is_taken_back_when_more_is_seen():
    water = camera((7.0, 5.5), (7.0, 4.5), (6.4, 6.2))
    localizer = settled(water)
    odometry = shifted(HERE, 0.0, 0.52, 0.0)  # a little nearer to the neighbour of the post than to the post itself
    localizer.update(camera((7.0, 4.5)).render(HERE), odometry, 120.0)
    assert localizer.locate(odometry).y == pytest.approx(6.0, abs=0.15)
    assert any(h.map.pose(odometry).y == pytest.approx(5.0, abs=0.15) for h in localizer.hypotheses[1:])
    for _ in range(20):
        pose = localizer.update(water.render(HERE), odometry, 0.1)
    assert pose[:2] == pytest.approx(HERE[:2], abs=0.15)
    assert len(localizer.hypotheses[0].map.centres) == 3


def test_once_one_hypothesis_prevails_it_is_told_which_pictures_were_misplaced():
    water = camera((7.0, 5.5), (7.0, 4.5), (6.4, 6.2))
    localizer = settled(water, cfg=dataclasses.replace(DRIFTS, less_likely=5.0))
    odometry = shifted(HERE, 0.0, 0.52, 0.0)
    localizer.update(camera((7.0, 4.5)).render(HERE), odometry, 120.0)
    misplaced = [math.dist(localizer.locate(odometry)[:2], HERE[:2]) > 0.5]
    told = []
    for _ in range(60):
        told.append((len(misplaced), localizer.mistaken))
        misplaced.append(math.dist(localizer.update(water.render(HERE), odometry, 0.1)[:2], HERE[:2]) > 0.5)
    told.append((len(misplaced), localizer.mistaken))
    assert misplaced[0]
    assert not misplaced[-1]
    seen, spans = next(one for one in told if one[1])
    before = seen - 2  # the last picture before the one that decided
    taken_back = {k for first, end in spans for k in range(before - first, before - end)}
    assert taken_back == {k for k in range(seen - 1) if misplaced[k]}


def test_one_hypothesis_cannot_take_a_match_back():
    water = camera((7.0, 5.5), (7.0, 4.5), (6.4, 6.2))
    localizer = settled(water, cfg=dataclasses.replace(DRIFTS, hypotheses=1))
    odometry = shifted(HERE, 0.0, 0.52, 0.0)
    localizer.update(camera((7.0, 4.5)).render(HERE), odometry, 120.0)
    for _ in range(20):
        pose = localizer.update(water.render(HERE), odometry, 0.1)
    assert pose.y > 5.5


def test_large_maps_leave_room_for_fewer_hypotheses():
    water = camera((7.0, 5.5), (7.0, 4.5), (6.4, 6.2))
    localizer = settled(water, cfg=dataclasses.replace(DRIFTS, entries=2 * 9**2))
    localizer.update(camera((7.0, 4.5)).render(HERE), shifted(HERE, 0.0, 0.52, 0.0), 120.0)
    assert len(localizer.hypotheses) == 2


def test_two_fresh_posts_that_fit_old_ones_close_the_loop():
    water = camera((7.0, 5.5), (7.4, 4.3))
    localizer = settled(water)
    odometry = shifted(HERE, 0.9, 0.6, 0.0)  # nearer to the other post than to the right one
    for k in range(30):
        pose = localizer.update(water.render(HERE), odometry, 200.0 if k == 0 else 0.1)
    assert pose[:2] == pytest.approx(HERE[:2], abs=0.15)
    assert len(localizer.hypotheses[0].map.centres) == 2


def test_a_new_post_becomes_a_landmark():
    localizer = settled(camera((7.0, 5.0)))
    localizer.update(camera((7.0, 5.0), (6.5, 6.8)).render(HERE), HERE, 0.5)
    np.testing.assert_allclose(localizer.hypotheses[0].map.centres, [(7.0, 5.0), (6.5, 6.8)], atol=0.1)


def test_pictures_are_used_once_a_period():
    water = camera((7.0, 5.0))
    localizer = settled(water, ticks=1)
    localizer.update(water.render(HERE), HERE, 0.4)
    assert localizer.sigma[0] == pytest.approx(0.06 * math.sqrt(0.4))
    localizer.update(water.render(HERE), HERE, 0.1)
    assert localizer.sigma[0] < 0.999 * 0.06 * math.sqrt(0.5)


def mission(pond, folder, localization, seed=0, seconds=60.0):
    noise = SensorNoiseCfg(
        visibility_m=4.0, obstacle_missed=0.1, obstacle_false=0.01, depth_sigma=0.03, drift_xy=0.06, drift_theta=0.006
    )
    cfg = MissionCfg(
        time_limit_s=seconds,
        latency="fixed:3",
        stop_when_covered=False,
        simulator=SimulatorCfg(noise=noise),
        localization=localization,
        record=RecordCfg(pictures=False, frames=False, report=False),
    )
    return Mission(pond, cfg, RuleAdvisor(REEF_RULES), folder, seed=seed).run()


@pytest.mark.slow
def test_a_mission_ends_nearer_to_its_map_than_the_odometry(pond, tmp_path):
    found = [mission(pond, tmp_path / str(seed), DRIFTS, seed) for seed in range(3)]
    assert sum(m["position_error_m"] for m in found) < 0.7 * sum(m["odometry_error_m"] for m in found)


def test_without_localization_the_pose_is_the_odometry_s(pond, tmp_path):
    found = mission(pond, tmp_path / "run", dataclasses.replace(DRIFTS, drift_xy=0.0, drift_theta=0.0), seconds=15.0)
    assert found["position_error_m"] == found["odometry_error_m"] > 0.05


def told(sigma):
    return np.diag(np.square(sigma))


def test_the_doubt_without_landmarks_is_what_the_odometry_tells():
    localizer, frame = Localizer(CAMERA), camera().render(HERE)
    covariance = np.array([[0.04, 0.01, 0.002], [0.01, 0.09, 0.001], [0.002, 0.001, 0.0025]])
    localizer.update(frame, HERE, 0.0, np.zeros((3, 3)))
    localizer.update(frame, shifted(HERE, 0.5, 0.2, 0.0), 1.0, 0.3 * covariance)
    there = shifted(HERE, 0.9, -0.3, 0.1)
    assert localizer.update(frame, there, 1.0, covariance) == pytest.approx(there)
    assert localizer.active
    assert localizer.hypotheses[0].map._covariance == pytest.approx(covariance, abs=1e-9)


def test_posts_seen_again_correct_an_odometry_that_tells_its_doubt():
    water, cfg = camera((7.0, 5.4), (6.6, 3.9), (7.3, 6.4)), LocalizationCfg()
    localizer = Localizer(CAMERA, cfg)
    for k in range(60):
        localizer.update(water.render(HERE), HERE, 0.1 if k else 0.0, told((0.01, 0.01, 0.001)))
    odometry = shifted(HERE, 0.3, -0.2, 0.05)
    for _ in range(60):
        pose = localizer.update(water.render(HERE), odometry, 0.1, told((0.5, 0.5, 0.05)))
    assert pose[:2] == pytest.approx(HERE[:2], abs=0.17)
    assert max(localizer.sigma[:2]) < 0.4


def test_a_covariance_may_be_ignored():
    localizer = Localizer(CAMERA, LocalizationCfg(use_covariance=False))
    assert localizer.update(camera().render(HERE), HERE, 0.1, told((0.5, 0.5, 0.05))) is HERE
    assert not localizer.active


REEF = (7.0, 5.4), (6.6, 3.9), (7.3, 6.4), (8.2, 4.6), (6.4, 6.5), (8.6, 3.6)


def resumed(saved, water, off, ticks=60):
    """Localizer that goes on with saved landmarks, where its odometry is off; and its pose."""
    localizer = Localizer(CAMERA, DRIFTS)
    localizer.recall(saved)
    for k in range(ticks):
        pose = localizer.update(water.render(HERE), shifted(HERE, *off), 0.1 if k else 0.0)
    return localizer, pose


@pytest.mark.parametrize("off", [(0.5, -0.2, 0.08), (-0.7, 0.7, -0.17), (0.0, 0.0, 0.0)])
def test_a_resumed_survey_finds_itself_by_saved_landmarks(off):
    water = camera(*REEF)
    localizer, pose = resumed(settled(water).hypotheses[0].map, water, off)
    assert localizer.recognised == localizer.saved == 6
    assert pose[:2] == pytest.approx(HERE[:2], abs=0.2)
    assert abs(pose.theta) < 0.06


def test_landmarks_of_another_reef_move_nothing():
    saved = settled(camera(*REEF)).hypotheses[0].map
    localizer, pose = resumed(saved, camera((6.2, 4.2), (8.5, 6.6), (7.6, 3.1)), (0.3, 0.1, 0.05))
    assert localizer.recognised == 0
    assert pose == pytest.approx(shifted(HERE, 0.3, 0.1, 0.05), abs=0.05)


def test_exact_odometry_stays_exact_while_landmarks_are_kept_for_another_survey():
    water = camera(*REEF)
    localizer = Localizer(CAMERA)
    localizer.recall(LandmarkMap())
    for k in range(20):
        assert localizer.update(water.render(HERE), HERE, 0.1 if k else 0.0) == pytest.approx(HERE)
    np.testing.assert_allclose(sorted(map(tuple, localizer.hypotheses[0].map.centres)), sorted(REEF), atol=0.15)


def test_a_start_with_a_wrong_heading_is_led_astray_as_it_drives():
    localizer = Localizer(CAMERA, DRIFTS)
    localizer.recall(settled(camera(*REEF)).hypotheses[0].map)
    empty = camera()
    for k in range(40):
        localizer.update(empty.render(HERE), Pose(5.0 + 0.1 * k, 5.0, 0.0), 0.1)
    x, y, _ = localizer.kept.sigma
    assert y > 1.15 > 1.05 > x
