"""Where the hull can get from the start, and what lies within its reach."""

import math

import numpy as np
import pytest

from coral.reef.world.reachability import distance_to, free_space, obstacle_outline, unreachable_clusters
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start


def slab(x0, x1, y0, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def test_a_cluster_behind_a_ring_of_posts_is_unreachable():
    """A ring of posts lets nobody in; without line of sight, nearness does not count."""
    posts = tuple(
        Obstacle(shape="cylinder", x=7.1 + 1.2 * math.cos(a), y=5.0 + 1.2 * math.sin(a), z=0.7, size=(0.2, 0.2, 0.7))
        for a in np.linspace(0, 2 * math.pi, 24, endpoint=False)
    )
    clusters = tuple(
        Cluster(name=name, oysters=(Oyster(x=7.1, y=y, z=0.05, radii=(0.1, 0.08, 0.05)),))
        for name, y in (("inside", 5.0), ("outside", 8.0))
    )
    closed = ReefWorld(name="ring", size_m=(10.0, 10.0), start=Start(x=2.0, y=5.0), clusters=clusters, obstacles=posts)
    assert unreachable_clusters(closed) == [0]
    assert unreachable_clusters(closed.model_copy(update={"obstacles": posts[::4]})) == []


def test_the_hull_does_not_leave_the_world_to_get_around():
    space = free_space((10.0, 10.0), [slab(4.9, 5.1, -1.0, 11.0)], (2.0, 5.0))
    assert space.reachable[100, 40]
    assert not space.reachable[100, 160]
    assert not space.sees(np.array([(5.9, 5.0)]))
    assert space.sees(np.array([(4.0, 5.0)]))


def test_the_hull_keeps_its_radius_from_obstacles():
    space = free_space((10.0, 10.0), [slab(6.0, 10.0, 0.0, 10.0)], (2.0, 5.0), radius_m=0.5)
    assert space.solid[100, 120:].all()
    assert not space.solid[100, :118].any()
    assert np.flatnonzero(space.reachable[100]).max() * space.cell_m == pytest.approx(5.5, abs=0.1)


def test_line_of_sight_ends_at_a_thin_wall():
    beside = np.array([(5.4, 5.0)])
    assert not free_space((10.0, 10.0), [slab(5.0, 5.1, 0.0, 10.0)], (2.0, 5.0)).sees(beside)
    assert free_space((10.0, 10.0), [], (2.0, 5.0)).sees(beside)


def test_the_hull_looks_into_a_slit_that_it_does_not_fit_into_as_far_as_its_range():
    slit = [slab(5.0, 10.0, 0.0, 4.75), slab(5.0, 10.0, 5.25, 10.0)]
    space = free_space((10.0, 10.0), slit, (2.0, 5.0))
    assert not space.reachable[100, 120]
    assert space.sees(np.array([(6.0, 5.0)]), range_m=2.0)
    assert not space.sees(np.array([(6.0, 5.0)]), range_m=1.0)


@pytest.mark.parametrize(("x", "y", "expected"), [(0.0, 0.0, -0.5), (2.0, 0.0, 1.0), (2.0, 1.5, math.sqrt(2))])
def test_distance_to_a_turned_box(x, y, expected):
    box = Obstacle(shape="box", x=3.0, y=4.0, z=0.5, size=(1.0, 0.5, 0.5), yaw=0.7)
    c, s = math.cos(0.7), math.sin(0.7)
    gap = distance_to(obstacle_outline(box), 3.0 + c * x - s * y, 4.0 + s * x + c * y)
    assert gap == pytest.approx(expected, abs=1e-6)


def test_outline_of_a_round_obstacle_is_its_circle():
    post = Obstacle(shape="cylinder", x=1.0, y=2.0, z=0.5, size=(0.4, 0.4, 0.5))
    outline = obstacle_outline(post)
    assert np.allclose(np.hypot(*(outline - (1.0, 2.0)).T), 0.4)
