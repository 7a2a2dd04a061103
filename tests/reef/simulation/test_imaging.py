import math

import numpy as np
import pytest

from coral.reef.simulation.coverage import CoverageMeter
from coral.reef.simulation.imaging import ImagingCfg, ImagingMeter
from coral.reef.vehicle.camera import Camera, CameraCfg, T_world_camera
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start


def disc(x, y, r=0.15, name="c", z=0.05):
    return Cluster(name=name, oysters=(Oyster(x=x, y=y, z=z, radii=(r, r, 0.05)),))


def world(clusters, obstacles=()):
    return ReefWorld(name="w", size_m=(20, 20), start=Start(x=1, y=1), clusters=tuple(clusters), obstacles=obstacles)


def meter(clusters, obstacles=(), cfg=None, camera=None, **keys):
    return ImagingMeter(Scene.from_world(world(clusters, obstacles)), camera, cfg, **keys)


def seen(pose, cluster, obstacles=(), **keys):
    """(imaged, inspected) share of one cluster from one place."""
    watch = meter((cluster,), obstacles, **keys)
    watch.update(pose)
    return watch.imaged, watch.inspected


def test_near_is_inspected_far_is_imaged_farther_is_neither():
    # 0.05 m pixels: 0.05 x 46.2 px of focal length = 2.31 m along the line of sight, from 1 m above the floor.
    assert meter((disc(7, 5),)).inspection_m == pytest.approx(0.05 * 80 / math.tan(math.radians(60)))
    assert seen(Pose(5, 5, 0), disc(6.5, 5)) == (1.0, 1.0)
    assert seen(Pose(5, 5, 0), disc(9, 5)) == (1.0, 0.0)
    assert seen(Pose(5, 5, 0), disc(11.2, 5)) == (0.0, 0.0)
    assert seen(Pose(5, 5, 0), disc(11.2, 5), cfg=ImagingCfg(range_m=8.0)) == (1.0, 0.0)


def test_a_finer_camera_inspects_from_farther_away():
    fine = CameraCfg(width=320, height=240)
    assert seen(Pose(5, 5, 0), disc(8.5, 5), camera=fine) == (1.0, 1.0)
    assert seen(Pose(5, 5, 0), disc(8.5, 5)) == (1.0, 0.0)


def test_behind_and_beside_the_picture_nothing_is_seen():
    assert seen(Pose(5, 5, math.pi), disc(6.5, 5)) == (0.0, 0.0)
    # Looking 15 degrees down, the picture is wider on the floor than its 60 degrees to either side.
    for degrees, expected in ((50, 1.0), (75, 0.0)):
        bearing = math.radians(degrees)
        away = disc(5 + 1.7 * math.cos(bearing), 5 + 1.7 * math.sin(bearing))
        assert seen(Pose(5, 5, 0), away)[1] == expected


def test_below_the_picture_nothing_is_seen():
    """The lower edge looks 52.4 + 15 degrees down: from 0.95 m above an oyster it meets it 0.39 m ahead."""
    assert seen(Pose(5, 5, 0), disc(5.2, 5, r=0.08)) == (0.0, 0.0)
    assert seen(Pose(5, 5, 0), disc(5.6, 5, r=0.08)) == (1.0, 1.0)
    # Looking up, the floor ahead is out of the picture although bearing and distance are right.
    up = CameraCfg(pitch_down_deg=-60.0)
    assert seen(Pose(5, 5, 0), disc(6.5, 5), camera=up) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("shape", "size"), [("box", (0.1, 1.0, 0.8)), ("ellipsoid", (0.2, 1.0, 0.8)), ("cylinder", (0.5, 0.5, 0.8))]
)
def test_an_oyster_behind_a_rock_is_not_imaged(shape, size):
    rock = Obstacle(shape=shape, x=6.2, y=5, z=0.6, size=size)
    assert seen(Pose(5.3, 5, 0), disc(7.1, 5), (rock,)) == (0.0, 0.0)
    assert seen(Pose(8.9, 5, math.pi), disc(7.1, 5), (rock,)) == (1.0, 1.0)


@pytest.mark.parametrize(("shape", "size"), [("box", (0.1, 1.0, 0.1)), ("cylinder", (0.5, 0.5, 0.1))])
def test_a_low_rock_is_looked_over(shape, size):
    """The ground plane alone would hide it; the camera, 1 m up, looks over a stone of 0.2 m."""
    stone = Obstacle(shape=shape, x=6.0, y=5, z=0.1, size=size)
    assert seen(Pose(5.2, 5, 0), disc(7, 5), (stone,)) == (1.0, 1.0)
    scene = Scene.from_world(world((disc(7, 5),), (stone,)))
    old = CoverageMeter(scene)
    old.update(Pose(5.2, 5, 0))
    assert old.coverage == 0.0


def test_nothing_is_seen_beyond_the_visibility():
    for away, clear, murky in ((4.0, (1.0, 0.0), (0.0, 0.0)), (1.5, (1.0, 1.0), (1.0, 1.0))):
        assert seen(Pose(5, 5, 0), disc(5 + away, 5)) == clear
        assert seen(Pose(5, 5, 0), disc(5 + away, 5), visibility_m=3.0) == murky
    # Murkier than the resolution demands: inspected ends where seeing ends.
    assert seen(Pose(5, 5, 0), disc(6.9, 5), visibility_m=1.5) == (0.0, 0.0)


def test_what_was_seen_stays_seen_and_the_better_look_counts():
    watch = meter((disc(9, 5),))
    watch.update(Pose(5, 5, 0))
    watch.update(Pose(5, 5, math.pi))
    assert (watch.imaged, watch.inspected) == (1.0, 0.0)
    watch.update(Pose(7.5, 5, 0))
    assert (watch.imaged, watch.inspected) == (1.0, 1.0)
    watch.update(Pose(math.nan, 5, 0))
    assert watch.inspected == 1.0


def test_points_under_a_rock_are_not_part_of_the_area():
    rock = Obstacle(shape="box", x=8, y=5.5, z=0.3, size=(1.0, 0.5, 0.3))
    watch = meter((disc(8, 5, r=0.3),), (rock,))
    assert watch.points[:, 1].max() < 5.0
    assert len(watch.points) == pytest.approx(0.5 * math.pi * 0.3**2 / 0.05**2, rel=0.15)


def reefscape(seed):
    rng = np.random.default_rng(seed)
    clusters = tuple(
        Cluster(
            name=f"c{k}",
            oysters=tuple(
                Oyster(x=x, y=y, z=0.04, radii=tuple(rng.uniform(0.05, 0.12, 3)), rpy=tuple(rng.uniform(-3, 3, 3)))
                for x, y in rng.uniform(3, 9, 2) + rng.normal(0, 0.4, (15, 2))
            ),
        )
        for k in range(5)
    )
    obstacles = []
    for k in range(16):
        a, b, c = rng.uniform(0.1, 0.6, 3)
        shape = ("box", "ellipsoid", "cylinder", "sphere")[k % 4]
        size = {"cylinder": (a, a, c), "sphere": (a, a, a)}.get(shape, (a, b, c))
        x, y = rng.uniform(1, 11, 2)
        obstacles.append(Obstacle(shape=shape, x=x, y=y, z=0.5, size=size, yaw=rng.uniform(-3, 3)))
    return world(clusters, tuple(obstacles))


def twin(watch, scene, transform, visibility=math.inf):
    """Levels of all points from one picture, by sampling the lines of sight. Shape=(M,)."""
    eye, local = transform[:3, 3], (watch.points - transform[:3, 3]) @ transform[:3, :3]
    camera = watch.camera
    fx, fy, cx, cy = camera.intrinsics
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = cx + fx * local[:, 0] / local[:, 2], cy + fy * local[:, 1] / local[:, 2]
    distance = np.linalg.norm(local, axis=1)
    visible = (local[:, 2] >= camera.near_m) & (distance <= min(6.0, visibility))
    visible &= (u >= -0.5) & (u <= camera.width - 0.5) & (v >= -0.5) & (v <= camera.height - 0.5)
    samples = eye + np.linspace(0.0, 1.0, 500)[None, :, None] * (watch.points - eye)[:, None, :]
    for k in np.flatnonzero(scene.label == Label.OBSTACLE):
        q = np.abs((samples - scene.center[k]) @ scene.rotation[k] / scene.half[k])
        inside = {
            0: (q**2).sum(-1) < 1.0,
            1: (q < 1.0).all(-1),
            2: (np.hypot(q[..., 0], q[..., 1]) < 1.0) & (q[..., 2] < 1.0),
        }[int(scene.kind[k])]
        visible &= ~inside.any(axis=1)
    return np.where(visible, np.where(distance <= watch.inspection_m, 2, 1), 0)


@pytest.mark.parametrize("seed", [3])
def test_levels_equal_a_plain_search(seed):
    scene = Scene.from_world(reefscape(seed))
    watch = ImagingMeter(scene)
    expected = np.zeros(len(watch.points), int)
    rng = np.random.default_rng(seed)
    for _ in range(6):
        pose = Pose(*rng.uniform(1, 11, 2), rng.uniform(-3, 3))
        watch.update(pose)
        expected = np.maximum(expected, twin(watch, scene, T_world_camera(pose, CameraCfg())))
    assert 0.1 < (expected == 2).mean() < 0.9
    assert (watch.level != expected).mean() < 0.004
    for name, least in (("imaged", 1), ("inspected", 2)):
        by_hand = [(watch.level[watch.group == c] >= least).mean() for c in range(5)]
        np.testing.assert_allclose(watch.fractions(name), by_hand)


def test_a_drive_is_the_sum_of_its_pictures():
    scene = Scene.from_world(reefscape(5))
    rng = np.random.default_rng(5)
    poses = np.stack([*rng.uniform(1, 11, (2, 8)), rng.uniform(-3, 3, 8)], axis=1)
    watch, other = ImagingMeter(scene), ImagingMeter(scene)
    for pose in poses:
        watch.update(Pose(*pose))
    level, count = np.zeros(len(other.points), np.uint8), np.zeros((3, 5), np.int64)
    assert other.look_along(poses, level, count) is None
    np.testing.assert_array_equal(level, watch.level)
    assert other.inspected == 0.0  # somebody else's record
    again, counted = np.zeros_like(level), np.zeros_like(count)
    shares = []
    for k in range(len(poses)):
        other.look(Pose(*poses[k]), again, counted)
        shares.append(float((counted[2] / other.size).mean()))
    half = shares[-1] / 2
    first = next(k for k, share in enumerate(shares) if share >= half)
    assert other.look_along(poses, np.zeros_like(level), np.zeros_like(count), target=half) == first


def test_it_agrees_with_the_pictures_that_the_camera_takes():
    """Where a point counts as seen, the camera's pixel there shows no obstacle; and the other way round."""
    scene = Scene.from_world(reefscape(6))
    camera, rng, wrong, looked = Camera(scene), np.random.default_rng(6), 0, 0
    fx, fy, cx, cy = camera.cfg.intrinsics
    for _ in range(8):
        pose = Pose(*rng.uniform(1, 11, 2), rng.uniform(-3, 3))
        labels = camera.render(pose).labels
        watch = ImagingMeter(scene)
        watch.update(pose)
        transform = T_world_camera(pose, camera.cfg)
        local = (watch.points - transform[:3, 3]) @ transform[:3, :3]
        near = (local[:, 2] > 0.1) & (np.linalg.norm(local, axis=1) < 6.0)
        u, v = (np.rint(c + f * local[:, k] / local[:, 2]).astype(int) for c, f, k in ((cx, fx, 0), (cy, fy, 1)))
        near &= (u >= 0) & (u < camera.cfg.width) & (v >= 0) & (v < camera.cfg.height)
        hidden = labels[v[near], u[near]] == Label.OBSTACLE
        looked += int(near.sum())
        wrong += int((hidden == (watch.level[near] > 0)).sum())
    assert looked > 500
    assert wrong / looked < 0.05  # a point and its pixel's centre are up to half a pixel apart
