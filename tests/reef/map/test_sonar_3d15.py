"""The simulated sonar: beams against plain geometry, and its errors."""

import dataclasses
import math

import numpy as np
import pytest

from coral.reef.map.sonar_3d15 import NOTHING, SEABED, SURFACE, Sonar3d15, SonarCfg, echoes_in_picture, sonar_attitude
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import BOX, ELLIPSOID, Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

EXACT = SonarCfg(
    width=64, height=24, resolution_m=0.0, sigma_m=0.0, sigma_share=0.0, dropout=0.0, grazing_deg=0.0, multipath=0.0
)
OBSTACLES = (
    Obstacle(shape="sphere", x=8.0, y=5.0, z=1.0, size=(0.3, 0.3, 0.3)),
    Obstacle(shape="box", x=7.0, y=6.5, z=0.6, size=(0.3, 0.2, 0.6), yaw=0.5),
    Obstacle(shape="cylinder", x=7.5, y=3.5, z=0.7, size=(0.2, 0.2, 0.7)),
    Obstacle(shape="ellipsoid", x=10.0, y=5.8, z=0.4, size=(0.6, 0.3, 0.5), yaw=-0.7),
    Obstacle(shape="box", x=3.0, y=5.0, z=0.5, size=(0.2, 0.2, 0.5)),  # behind
)


def scene(*obstacles):
    reef = Cluster(name="c", oysters=(Oyster(x=6.5, y=5.2, z=0.05, radii=(0.1, 0.08, 0.05), rpy=(0.2, 0.1, 0.4)),))
    return Scene.from_world(
        ReefWorld(name="w", size_m=(20, 20), start=Start(x=5, y=5), clusters=(reef,), obstacles=obstacles)
    )


def sonar(there, cfg=EXACT, **keys):
    return Sonar3d15(there, cfg, np.random.default_rng(0), **keys)


def cast_by_hand(there, eye, beam, range_m=15.0):
    """Test one beam against everything, one after the other."""
    best = (seabed, SEABED) if beam[2] < 0 and (seabed := -eye[2] / beam[2]) <= range_m else (math.inf, NOTHING)
    for i in range(len(there)):
        o = there.rotation[i].T @ (eye - there.center[i]) / there.half[i]
        d = there.rotation[i].T @ beam / there.half[i]
        if there.kind[i] == ELLIPSOID:
            roots = np.roots([d @ d, 2 * o @ d, o @ o - 1.0])
            interval = sorted(roots.real) if np.isreal(roots).all() else (1.0, 0.0)
        else:
            slabs = [sorted(((-1 - o[k]) / d[k], (1 - o[k]) / d[k])) for k in range(3)]
            if there.kind[i] != BOX:
                roots = np.roots([d[:2] @ d[:2], 2 * o[:2] @ d[:2], o[:2] @ o[:2] - 1.0])
                slabs = [slabs[2], sorted(roots.real) if np.isreal(roots).all() else (1.0, 0.0)]
            interval = max(low for low, _ in slabs), min(high for _, high in slabs)
        if interval[0] <= interval[1] and 0.0 < interval[0] < min(best[0], range_m):
            best = interval[0], i
    return best


@pytest.mark.parametrize(("roll", "pitch", "theta"), [(0.0, 0.0, 0.0), (0.2, -0.1, 0.3), (-0.3, 0.2, -0.5)])
def test_beams_meet_what_a_search_over_everything_meets(roll, pitch, theta):
    there = scene(*OBSTACLES)
    device = sonar(there)
    image = device.image(Pose(5.0, 5.0, theta), 1.0, roll=roll, pitch=pitch)
    beams = image.directions() @ sonar_attitude(theta, roll, pitch, 15.0).T
    met = set()
    for v in range(24):
        for u in range(0, 64, 2):
            expected, what = cast_by_hand(there, np.array([5.0, 5.0, 1.0]), beams[v, u])
            assert device.hit[v, u] == what
            assert image.ranges[v, u] == pytest.approx(expected, abs=1e-5)
            met.add(what)
    assert len(met & {1, 2, 3, 4}) >= 2


def test_the_sonar_sees_the_scene_that_the_camera_sees():
    there = scene(*OBSTACLES)
    camera = CameraCfg(width=161, height=121)
    frame = Camera(there, camera).render(Pose(5.0, 5.0, 0.0))
    device = sonar(there, dataclasses.replace(EXACT, width=3, height=3, hfov_deg=20.0, vfov_deg=20.0))
    image = device.image(Pose(5.0, 5.0, 0.0), 1.0)
    # The middle beam runs along the camera's optical axis: there range and depth are the same.
    assert image.ranges[1, 1] == pytest.approx(frame.depth[60, 80], abs=1e-4)
    assert device.hit[1, 1] == frame.instances[60, 80]


def test_a_solid_about_the_sonar_is_met_from_inside():
    device = sonar(scene(Obstacle(shape="sphere", x=5.0, y=5.0, z=1.0, size=(0.9, 0.9, 0.9))))
    assert device.image(Pose(5.0, 5.0, 0.0), 1.0).ranges == pytest.approx(0.9, abs=1e-5)


def test_the_surface_is_met_only_where_there_is_one():
    cfg = dataclasses.replace(EXACT, pitch_down_deg=0.0)
    there = scene()
    open_water, pool = sonar(there, cfg), sonar(there, cfg, surface_z=1.5)
    assert np.isinf(open_water.image(Pose(5.0, 5.0, 0.0), 1.0).ranges[-1]).all()
    assert pool.image(Pose(5.0, 5.0, 0.0), 1.0).ranges[-1, 0] == pytest.approx(0.5 / math.sin(math.radians(20.0)))
    assert (pool.hit[-1] == SURFACE).all()


def measured(ranges, **errors):
    device = sonar(scene(), dataclasses.replace(EXACT, width=200, height=60, **errors))
    device.hit[:] = 0
    shape = (60, 200)
    return device._measured(np.full(shape, ranges), np.full(shape, 0.05))


def test_without_errors_ranges_are_exact():
    assert (measured(4.0) == 4.0).all()


@pytest.mark.parametrize(
    ("ranges", "errors", "lost"),
    [
        (4.0, {"dropout": 0.3}, 0.3),
        (0.2, {}, 1.0),  # nearer than it can hear
        (14.9, {"multipath": 1.0, "detour_m": 4.0}, 0.975),  # a detour of more than 0.1 m leads out of range
    ],
)
def test_beams_get_lost(ranges, errors, lost):
    assert np.isinf(measured(ranges, **errors)).mean() == pytest.approx(lost, abs=0.03)


def test_ranges_are_noisy_and_stepped():
    found = measured(4.0, sigma_m=0.02, sigma_share=0.005, resolution_m=0.01)
    assert found.std() == pytest.approx(0.04, rel=0.05)
    assert np.abs(found / 0.01 - np.round(found / 0.01)).max() < 1e-3


def test_a_detour_makes_an_echo_seem_farther_in_whole_patches():
    found = measured(4.0, multipath=0.2, detour_m=2.0)
    late = found > 4.0
    assert late.mean() == pytest.approx(0.2, abs=0.06)
    assert found.min() == 4.0
    assert found.max() < 6.0
    blocks = found[:60, :200].reshape(15, 4, 25, 8)
    assert (blocks == blocks[:, :1, :, :1]).all()


def test_flat_echoes_of_the_floor_get_lost():
    device = sonar(scene(), dataclasses.replace(EXACT, grazing_deg=10.0))
    exact, image = sonar(scene()).image(Pose(5, 5, 0), 1.0), device.image(Pose(5, 5, 0), 1.0)
    steep, flat = slice(0, 4), slice(15, 18)
    assert (image.ranges[steep] == exact.ranges[steep]).all()
    assert np.isinf(image.ranges[flat]).mean() > np.isinf(exact.ranges[flat]).mean() + 0.1


def test_the_same_seed_gives_the_same_image():
    images = [sonar(scene(*OBSTACLES), SonarCfg()).image(Pose(5, 5, 0), 1.0) for _ in range(2)]
    assert images[0].ranges.tobytes() == images[1].ranges.tobytes()
    assert images[0].ranges.dtype == np.float32
    assert (images[0].ranges > 0.0).all()


def test_echoes_have_the_depth_that_the_camera_has_there():
    post, camera = scene(Obstacle(shape="box", x=8.0, y=5.0, z=1.0, size=(0.3, 0.6, 1.0))), CameraCfg()
    cfg = SonarCfg(enabled=True, sigma_m=0, sigma_share=0, dropout=0, multipath=0, grazing_deg=0, resolution_m=0)
    image = Sonar3d15(post, cfg, np.random.default_rng(0)).image(Pose(5.0, 5.0, 0.1), 1.0)
    points = echoes_in_picture(image, cfg.pitch_down_deg, camera)
    depth = Camera(post, camera).render(Pose(5.0, 5.0, 0.1)).depth
    at = np.round(points[:, :2]).astype(int)
    there = depth[at[:, 1], at[:, 0]]
    near = np.isfinite(there) & (points[:, 2] < 4.0)
    assert near.sum() > 5000
    # Half a pixel beside an edge, the camera sees something else.
    assert np.mean(np.abs(there[near] / points[near, 2] - 1.0) < 0.03) > 0.95


def test_what_is_not_heard_or_not_in_view_is_no_point():
    image = RangeImage(np.array([[np.inf, 2.0], [np.inf, np.inf]], np.float32), 170.0, 10.0)
    assert echoes_in_picture(image, 0.0, CameraCfg(hfov_deg=60.0)).shape == (0, 3)
