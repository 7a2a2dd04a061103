import dataclasses
import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.landmarks import DOUBTED_SIGMA_M, RANGE_SIGMA_M, LandmarkCfg, LandmarkDetector, Sighting
from coral.reef.map.landmarks_kernels import scan
from coral.reef.simulation.noise import SensorNoise, SensorNoiseCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Frame, Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

CAMERA = CameraCfg()
HERE = Pose(5.0, 5.0, 0.0)


def post(x, y, radius=0.2):
    return Obstacle(shape="cylinder", x=x, y=y, z=0.9, size=(radius, radius, 0.9))


def world(*obstacles):
    bed = Cluster(name="bed", oysters=(Oyster(x=0.5, y=9.5, z=0.05, radii=(0.1, 0.1, 0.06), rpy=(0.0, 0.0, 0.0)),))
    return ReefWorld(
        name="test", size_m=(10.0, 10.0), start=Start(x=5.0, y=5.0, theta=0.0), clusters=(bed,), obstacles=obstacles
    )


def seen(*obstacles, pose=HERE, **noise):
    frame = Camera(Scene.from_world(world(*obstacles)), CAMERA).render(pose)
    frame = SensorNoise(SensorNoiseCfg(**noise), np.random.default_rng(3), CAMERA).apply(frame)
    return LandmarkDetector(CAMERA).detect(frame)


def scan_by_hand(depth, labels, sector, length, limits, sectors):
    """Every sector on its own, with NumPy."""
    range_m, least, split_m = limits
    ranges, counts = np.full(sectors, np.inf), np.zeros(sectors, np.int64)
    for k in range(sectors):
        away = np.sort((depth * length)[(labels == Label.OBSTACLE) & (sector == k)])
        away = away[away <= range_m]
        if len(away) >= least:
            away = away[away <= away[len(away) // 5] + split_m]
            if len(away) >= least:
                ranges[k], counts[k] = away[len(away) // 2], len(away)
    return ranges, counts


def test_scan_agrees_with_its_twin():
    rng = np.random.default_rng(1)
    shape, sectors = (40, 60), 20
    depth = rng.choice([1.0, 1.1, 1.3, 2.5, 6.0, np.inf], shape).astype(np.float32)
    labels = rng.choice([0, 1, 2, 3], shape, p=[0.1, 0.1, 0.7, 0.1]).astype(np.uint8)
    sector, length = rng.integers(-1, sectors, shape), rng.uniform(0.9, 1.4, shape)
    for least in (1, 25, 400):
        limits = (5.0, least, 0.4)
        ranges, counts = np.zeros(sectors), np.zeros(sectors, np.int64)
        scan(depth, labels, sector, length, limits, ranges, counts)
        expected = scan_by_hand(depth, labels, sector, length, limits, sectors)
        np.testing.assert_array_equal(ranges, expected[0])
        np.testing.assert_array_equal(counts, expected[1])


@pytest.mark.parametrize("bearing_deg", [-35, -10, 0, 20, 40])
@pytest.mark.parametrize("distance", [1.2, 2.0, 2.8])
def test_a_post_is_found_where_it_stands(bearing_deg, distance):
    b = math.radians(bearing_deg)
    (found,) = seen(post(5.0 + distance * math.cos(b), 5.0 + distance * math.sin(b)))
    assert found.whole
    assert 0.5 * (found.right + found.left) == pytest.approx(b, abs=0.02)
    assert found.near_m + found.radius_m == pytest.approx(distance, abs=0.08)
    assert found.radius_m == pytest.approx(0.2, abs=0.06)


def test_noise_of_depth_is_averaged_over_the_post():
    found = seen(post(7.0, 5.0), depth_sigma=0.03, visibility_m=3.0, obstacle_missed=0.1, obstacle_false=0.01)
    assert len(found) == 1
    bearing, away = 0.5 * (found[0].right + found[0].left), found[0].near_m + found[0].radius_m
    assert (bearing, away) == pytest.approx((0.0, 2.0), abs=0.06)


def test_the_distance_of_a_post_is_surer_in_a_picture_without_doubt():
    frame = Camera(Scene.from_world(world(post(7.0, 5.0))), CAMERA).render(HERE)
    doubted = dataclasses.replace(frame, doubt=np.zeros_like(frame.depth))
    for picture, sigma_m in ((frame, RANGE_SIGMA_M), (doubted, DOUBTED_SIGMA_M)):
        (found,) = LandmarkDetector(CAMERA).detect(picture)
        assert found.sigma_m == sigma_m


def test_a_post_farther_away_than_the_eyes_see_is_not_measured():
    frame = Camera(Scene.from_world(world(post(7.0, 5.0))), CAMERA).render(HERE)
    assert LandmarkDetector(CAMERA).detect(frame, 2.5)
    assert LandmarkDetector(CAMERA).detect(frame, 1.5) == []


def test_nothing_stands_in_empty_water():
    assert seen() == []
    assert seen(obstacle_false=0.01, oyster_false=0.01) == []


def test_a_post_behind_another_shows_one_outline():
    far, near = (5.0 + 2.5, 5.0 + 0.45), (5.0 + 1.5, 5.0)
    first, second = seen(post(*near), post(*far))
    assert first.whole
    assert (second.right, second.whole) == (None, False)
    away = second.near_m + 0.2
    bearing = second.left - math.asin(0.2 / away)
    assert (bearing, away) == pytest.approx((math.atan2(0.45, 2.5), math.hypot(2.5, 0.45)), abs=0.08)


def test_a_post_at_the_picture_s_edge_shows_one_outline():
    b = math.radians(57)
    (found,) = seen(post(5.0 + 1.5 * math.cos(b), 5.0 + 1.5 * math.sin(b), 0.25))
    assert found.left is None
    assert found.right is not None


def test_radius_of_a_circle_by_hand():
    # A circle of radius 1 with its centre 2 m ahead appears under 60 degrees, 1 m away.
    whole = Sighting(right=-math.pi / 6, left=math.pi / 6, near_m=1.0, width=math.pi / 3)
    assert whole.radius_m == pytest.approx(1.0)


def test_a_wrong_patch_is_no_body():
    depth = np.full((CAMERA.height, CAMERA.width), 2.0, np.float32)
    labels = np.full(depth.shape, Label.SEABED, np.uint8)
    labels[80:86, 80:86] = Label.OBSTACLE
    frame = Frame(depth, labels, np.full(depth.shape, -1, np.int32))
    assert LandmarkDetector(CAMERA).detect(frame) == []
    assert LandmarkDetector(CAMERA, LandmarkCfg(sector_px=3, body_px=10)).detect(frame)


def test_a_picture_of_another_size_is_refused():
    large = Frame(np.ones((480, 640), np.float32), np.ones((480, 640), np.uint8), np.zeros((480, 640), np.int32))
    with pytest.raises(InputError, match="camera: depth"):
        LandmarkDetector(CAMERA).detect(large)
