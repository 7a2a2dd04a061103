"""What the robot remembers: its way, the clusters it may still visit, what the others say."""

import math
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.chain import Component
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.simulation.noise import SensorNoise, SensorNoiseCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Frame, Label, Pose
from coral.reef.world.scene import Scene

CAMERA = CameraCfg()
SHAPE = (CAMERA.height, CAMERA.width)
BARE = Frame(
    depth=np.full(SHAPE, 5.0, np.float32),
    labels=np.full(SHAPE, Label.SEABED, np.uint8),
    instances=np.full(SHAPE, -1, np.int32),
)
"""Bare seabed, 5 m of it in sight."""


def belief(*clusters, cfg=None):
    made = Belief(OccupancyMap((20.0, 20.0), CAMERA), cfg)
    made.pose = Pose(10.0, 10.0, 0.0)
    made.tracker.update([Component(x=x, y=y, area_px=200, length_m=1.0) for x, y in clusters])
    return made


def places(tracks):
    return [(t.x, t.y) for t in tracks]


def test_a_picture_of_bare_seabed_explores_what_lies_ahead_and_finds_nothing():
    made = belief()
    made.update(BARE, Pose(10.0, 10.0, 0.0))
    assert made.pose == (10.0, 10.0, 0.0)
    assert made.map.explored[200, 260]  # 3 m ahead
    assert not made.map.explored[200, 140]  # 3 m behind
    assert not made.map.obstacle.any()
    assert made.tracks == []


@pytest.mark.parametrize(("estimated", "seen", "left"), [(True, False, 1), (True, True, 2), (False, False, 2)])
def test_eyes_that_doubt_find_no_cluster_inside_a_boulder(estimated, seen, left):
    made = belief()
    cells = made.map
    cells.estimated = estimated
    cells.explored[:, :200] = True
    for x, y in ((5.0, 10.0), (14.0, 10.0)):  # the second one lies in water that nobody has seen
        iy, ix = cells.index(x, y)
        at = slice(iy - 6, iy + 6), slice(ix - 6, ix + 6)
        cells._targets[at], cells.target[at] = 5, True
        cells.explored[at] = seen
    for _ in range(20):
        made.update(None, made.pose)
    assert sum(len(track.cells) > 0 for track in made.tracks) == left


@pytest.mark.parametrize(("estimated", "left"), [(True, 0), (False, 1)])
def test_eyes_that_doubt_keep_no_cluster_that_was_given_up_unseen(estimated, left):
    made = belief()
    cells = made.map
    cells.estimated = estimated
    at = slice(194, 206), slice(94, 106)
    cells._targets[at], cells.target[at], cells.explored[:] = 5, True, True
    for k in range(20):
        if k == 10:
            for _ in range(made.cfg.max_attempts):
                made.goal = made.tracks[0].x, made.tracks[0].y
                made.goal_failed()
        made.update(None, made.pose)
    assert sum(len(track.cells) > 0 for track in made.tracks) == left


def test_what_was_seen_from_a_mistaken_place_is_to_be_seen_again():
    made = belief()
    made.update(BARE, Pose(5.0, 10.0, 0.0))
    seen = np.isfinite(made.map.nearest)
    for x in (9.0, 13.0):
        made.update(BARE, Pose(x, 10.0, 0.0))
    assert np.isfinite(made.map.nearest).sum() > seen.sum()
    made.look_again(1, -1)
    assert (np.isfinite(made.map.nearest) <= seen).all()
    made.look_again(99, -1)
    assert not np.isfinite(made.map.nearest).any()


def test_what_an_earlier_survey_saw_is_not_taken_back():
    made, before = belief(), belief()
    before.update(BARE, Pose(5.0, 10.0, 0.0))
    made.map.recall(before.map.memory())
    made.look_again(99, -1)
    assert np.array_equal(made.map.nearest, before.map.nearest)


def test_the_trajectory_is_remembered_at_its_spacing():
    made = belief(cfg=BeliefCfg(trail_step_m=0.5))
    for x in np.arange(5.0, 8.01, 0.125):
        made.update(BARE, Pose(float(x), 5.0, 0.0))
    np.testing.assert_allclose(made.trajectory, [(x, 5.0) for x in np.arange(5.0, 8.01, 0.5)])


def test_a_doubtful_cluster_is_left_out_until_nothing_else_is_left():
    made = belief((14.0, 10.0), (6.0, 10.0))
    made.tracker.tracks[0] = replace(made.tracks[0], doubtful=True)
    assert places(made.unvisited()) == [(6.0, 10.0)]
    assert len(made.unvisited(doubtful=True)) == 2


def test_a_cluster_where_most_pictures_show_seabed_is_doubtful():
    made = belief()
    made.map._targets[190:210, 270:290], made.map._ground[190:210, 270:290] = 5, 20
    made.map.target[190:210, 270:290] = True
    made.update(BARE, Pose(3.0, 3.0, math.pi))
    assert [t.doubtful for t in made.tracks] == [True]


def seen(pond, error_m=lambda x: 0.0, **noise):
    """What a robot knows that has come 2.4 m nearer to one bed of the pond, of its own position this wrong."""
    water = Camera(Scene.from_world(pond.model_copy(update={"clusters": pond.clusters[:1], "obstacles": ()})), CAMERA)
    errs = SensorNoise(SensorNoiseCfg(**noise), np.random.default_rng(0), CAMERA)
    made = Belief(OccupancyMap((14.0, 14.0), CAMERA))
    for x in np.arange(2.0, 4.4, 0.03):
        made.update(errs.apply(water.render(Pose(x, 3.5, 0.0))), Pose(x, 3.5 + error_m(x), 0.0))
    return made.tracks


def test_sensor_noise_that_looks_like_oysters_is_doubtful(pond):
    mapped = [t for t in seen(pond, oyster_false=0.03) if not t.far]
    assert len(mapped) > 1
    for track in mapped:
        assert track.doubtful is (math.dist((track.x, track.y), (6.0, 3.5)) > 1.0)


@pytest.mark.parametrize("metres", [0.5, 0.8, 1.2])
def test_a_cluster_that_drift_has_moved_keeps_one_dot(pond, metres):
    (track,) = seen(pond, lambda x: metres if x < 3.2 else 0.0)
    assert math.dist((track.x, track.y), (6.0, 3.5)) < metres


def test_a_cluster_whose_goals_failed_too_often_is_given_up():
    made = belief((14.0, 10.0), (6.0, 10.0), cfg=BeliefCfg(max_attempts=2))
    made.goal = (14.0, 10.2)
    made.goal_failed()
    assert len(made.unvisited()) == 2
    made.goal_failed()
    assert made.failures(14.0, 10.0) == 2
    assert made.failures(6.0, 10.0) == 0
    assert places(made.unvisited()) == [(6.0, 10.0)]


def test_a_snapshot_stays_as_it_is_while_the_robot_goes_on():
    made = belief()
    made.map.target[300:320, 40:60] = True
    made.update(BARE, Pose(16.0, 4.0, 0.0))
    made.water(CostFieldCfg())
    still = made.snapshot()
    cells, water = still.map.cells(), still.water(CostFieldCfg()).slowness.copy()
    tracks, way = list(still.tracks), still.trajectory
    made.map.obstacle[200:210, 60:70] = True
    made.map.target[360:380, 120:140] = True
    for k in range(1, 12):
        made.update(BARE, Pose(16.0, 4.0 + 0.2 * k, 0.0))
    assert made.water(CostFieldCfg()).slowness.min() < 0.0
    assert len(made.tracks) == 2
    np.testing.assert_array_equal(still.map.cells(), cells)
    np.testing.assert_array_equal(still.water(CostFieldCfg()).slowness, water)
    np.testing.assert_array_equal(still.trajectory, way)
    assert still.tracks == tracks
    assert still.pose == Pose(16.0, 4.0, 0.0)


@pytest.mark.parametrize(("doubts", "near_m", "stays"), [(True, 5.0, False), (True, 1.0, True), (False, 5.0, True)])
def test_oysters_that_were_seen_from_afar_only_are_none_once_given_up_where_eyes_doubt(doubts, near_m, stays):
    made = belief()
    seen = replace(BARE, doubt=np.full(SHAPE, 0.1, np.float32)) if doubts else BARE
    made.update(seen, Pose(2.0, 10.0, math.pi))
    cells = made.map
    cells.target[190:205, 270:285], cells.nearest[190:205, 270:275] = True, near_m
    while not made.tracks:
        made.update(None, made.pose)
    made.write_off(made.tracks[0].index)
    assert cells.target[190:205, 270:285].any() == stays
