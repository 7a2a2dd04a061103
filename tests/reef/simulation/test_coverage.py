import math

import numpy as np
import pytest

from coral.reef.simulation.coverage import CoverageCfg, CoverageMeter, rasterise
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import RECTANGLE, Footprints, Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start


def disc(x, y, r=0.3, name="c"):
    return Cluster(name=name, oysters=(Oyster(x=x, y=y, z=0, radii=(r, r, 0.1)),))


def meter(clusters, obstacles=(), **settings):
    scene = Scene.from_world(
        ReefWorld(name="w", size_m=(20, 20), start=Start(x=1, y=1), clusters=clusters, obstacles=obstacles)
    )
    return CoverageMeter(scene, CoverageCfg(**settings))


def area(watch, cluster):
    """A cluster's cells, and whether each has been seen."""
    its = watch._cluster == cluster
    return watch._cells[its], watch._seen[its]


def seen_from(pose, cluster, obstacles=(), **settings):
    watch = meter((cluster,), obstacles, **settings)
    watch.update(pose)
    return watch.fractions[0]


def test_ahead_is_seen_behind_is_not():
    assert seen_from(Pose(5, 5, 0), disc(8, 5)) == 1.0
    assert seen_from(Pose(5, 5, math.pi), disc(8, 5)) == 0.0


@pytest.mark.parametrize("side", [-1, 1])
def test_the_field_of_view_ends_at_sixty_degrees(side):
    for degrees, expected in ((50, 1.0), (70, 0.0)):
        bearing = side * math.radians(degrees)
        cluster = disc(5 + 3 * math.cos(bearing), 5 + 3 * math.sin(bearing))
        assert seen_from(Pose(5, 5, 0), cluster) == expected


def test_the_range_limit():
    assert seen_from(Pose(1, 5, 0), disc(7.4, 5)) == 0.0
    assert seen_from(Pose(1, 5, 0), disc(6.6, 5)) == 1.0
    assert seen_from(Pose(1, 5, 0), disc(7.0, 5)) == pytest.approx(0.5, abs=0.08)
    assert seen_from(Pose(1, 5, 0), disc(7.4, 5), range_m=7.0) == 1.0


@pytest.mark.parametrize(
    ("shape", "size"), [("box", (0.2, 1.0, 0.5)), ("ellipsoid", (0.2, 1.0, 0.5)), ("cylinder", (1.0, 1.0, 0.5))]
)
def test_an_obstacle_hides_what_is_behind_it(shape, size):
    wall = Obstacle(shape=shape, x=6.5, y=5, z=0.5, size=size)
    assert seen_from(Pose(5, 5, 0), disc(8.5, 5), (wall,)) == 0.0
    # From beside the wall, and from the far side of it.
    assert seen_from(Pose(8.5, 7, -math.pi / 2), disc(8.5, 5), (wall,)) == 1.0
    # An obstacle behind the cluster hides nothing, nor does one behind the robot.
    assert seen_from(Pose(12, 5, math.pi), disc(8.5, 5), (wall,)) == 1.0
    assert seen_from(Pose(7.6, 5, 0), disc(10, 5), (wall,)) == 1.0


def test_what_was_seen_stays_seen_and_adds_up():
    watch = meter((disc(7.0, 5),))
    watch.update(Pose(1, 5, 0))
    half = watch.fractions[0]
    watch.update(Pose(1, 5, math.pi))
    assert watch.fractions[0] == half
    watch.update(Pose(13, 5, math.pi))
    assert watch.fractions[0] > 0.95


def test_a_cluster_counts_from_sixty_percent():
    watch = meter((disc(7.0, 5, name="a"), disc(3.0, 5, name="b"), disc(1.0, 15, name="c"), disc(1, 18, name="d")))
    watch.update(Pose(1, 5, 0))
    assert watch.covered().tolist() == [False, True, False, False]
    assert watch.coverage == 0.25
    assert watch.fractions.shape == (4,)


def ellipses(*rows):
    table = np.array(rows, float)
    return Footprints(np.zeros(len(table), np.int8), table[:, :2].copy(), table[:, 2:4].copy(), table[:, 4].copy())


def test_closing_joins_near_oysters_and_keeps_far_ones_apart():
    near = ellipses((1.0, 1.0, 0.1, 0.1, 0), (1.3, 1.0, 0.1, 0.1, 0))
    bed, single = rasterise(near, 0.05, 0.15), rasterise(near, 0.05, 0.0)
    between = (bed[:, 0] > 1.1) & (bed[:, 0] < 1.2)
    assert between.any()
    assert not ((single[:, 0] > 1.1) & (single[:, 0] < 1.2)).any()
    # The outer edge stays.
    assert bed[:, 0].min() == single[:, 0].min()
    far = ellipses((1.0, 1.0, 0.1, 0.1, 0), (1.7, 1.0, 0.1, 0.1, 0))
    assert len(rasterise(far, 0.05, 0.15)) == len(rasterise(far, 0.05, 0.0))


def test_a_tiny_oyster_still_has_a_cell():
    np.testing.assert_allclose(rasterise(ellipses((1.01, -2.01, 0.004, 0.004, 0)), 0.05, 0.15), [[1.025, -2.025]])


def test_a_turned_ellipse_is_rasterised_turned():
    cells = rasterise(ellipses((0, 0, 1.0, 0.2, math.pi / 2)), 0.05, 0.0)
    assert np.abs(cells[:, 0]).max() < 0.2
    assert np.abs(cells[:, 1]).max() > 0.9


def test_cells_under_an_obstacle_are_not_part_of_the_area():
    rock = Obstacle(shape="box", x=8, y=5.5, z=0.3, size=(1.0, 0.5, 0.3))
    watch = meter((disc(8, 5),), (rock,))
    assert area(watch, 0)[0][:, 1].max() < 5.0
    watch.update(Pose(6, 4, 0.3))
    assert watch.fractions[0] == 1.0


def test_the_seen_cells_equal_a_plain_search():
    rng = np.random.default_rng(4)
    clusters = tuple(
        Cluster(
            name=f"c{k}",
            oysters=tuple(
                Oyster(x=x, y=y, z=0, radii=tuple(rng.uniform(0.05, 0.15, 3)), rpy=tuple(rng.uniform(-3, 3, 3)))
                for x, y in rng.uniform(2, 10, 2) + rng.normal(0, 0.4, (15, 2))
            ),
        )
        for k in range(5)
    )
    obstacles = tuple(
        Obstacle(
            shape=("box", "ellipsoid")[k % 2],
            x=rng.uniform(1, 11),
            y=rng.uniform(1, 11),
            z=0.5,
            size=tuple(rng.uniform(0.1, 0.6, 3)),
            yaw=rng.uniform(-3, 3),
        )
        for k in range(14)
    )
    scene = Scene.from_world(
        ReefWorld(name="w", size_m=(12, 12), start=Start(x=1, y=1), clusters=clusters, obstacles=obstacles)
    )
    watch, hiders = CoverageMeter(scene), scene.footprints()
    expected = [np.zeros(len(area(watch, k)[0]), bool) for k in range(5)]
    # Points along the line of sight; a hider that they just miss is too thin a cut to matter.
    s = np.linspace(0, 1, 400)
    for _ in range(4):
        pose = Pose(*rng.uniform(0, 12, 2), rng.uniform(-3, 3))
        watch.update(pose)
        for k in range(5):
            cells = area(watch, k)[0]
            ray = cells - [pose.x, pose.y]
            bearing = np.abs((np.arctan2(ray[:, 1], ray[:, 0]) - pose.theta + math.pi) % (2 * math.pi) - math.pi)
            visible = (np.hypot(*ray.T) <= 6.0) & (bearing <= math.pi / 3)
            points = np.array([pose.x, pose.y]) + s[None, :, None] * ray[:, None, :]
            for kind, center, half, yaw in zip(hiders.kind, hiders.center, hiders.half, hiders.yaw, strict=True):
                d = points - center
                x = (math.cos(yaw) * d[..., 0] + math.sin(yaw) * d[..., 1]) / half[0]
                y = (math.cos(yaw) * d[..., 1] - math.sin(yaw) * d[..., 0]) / half[1]
                inside = np.maximum(np.abs(x), np.abs(y)) if kind == RECTANGLE else np.hypot(x, y)
                visible &= ~(inside < 1).any(axis=1)
            expected[k] |= visible
    seen = np.concatenate([area(watch, k)[1] for k in range(5)])
    wanted = np.concatenate(expected)
    assert 0.2 < wanted.mean() < 0.9
    assert (seen != wanted).mean() < 0.003
    np.testing.assert_allclose(watch.fractions, [e.mean() for e in expected], atol=0.02)


def test_a_lost_pose_sees_nothing():
    assert seen_from(Pose(math.nan, 5, 0), disc(8, 5)) == 0.0
    assert seen_from(Pose(5, 5, math.nan), disc(8, 5)) == 0.0
