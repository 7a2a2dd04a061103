import itertools
import math

import pytest

from coral.errors import InputError
from coral.reef.simulation.starts import APART_M, starts_beside
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world, shipped_worlds


@pytest.mark.parametrize("name", shipped_worlds())
def test_four_robots_start_apart_and_clear_in_every_shipped_reef(name):
    world = load_world(name)
    first, shapes = Pose(world.start.x, world.start.y, world.start.theta), Scene.from_world(world).footprints()
    placed = starts_beside(first, 4, shapes, world.size_m, 0.3)
    assert placed[0] == first
    assert placed == starts_beside(first, 4, shapes, world.size_m, 0.3)
    for a, b in itertools.combinations(placed, 2):
        assert math.dist(a[:2], b[:2]) >= APART_M - 1e-6
    for x, y, theta in placed[1:]:
        assert clearance(shapes, x, y) >= 0.6
        assert min(x, y, world.size_m[0] - x, world.size_m[1] - y) >= 0.6
        assert theta == first.theta


def test_a_start_without_room_is_refused_with_the_number_that_fits(pond):
    with pytest.raises(InputError, match="at most 1"):
        starts_beside(Pose(1.0, 1.0, 0.0), 2, Scene.from_world(pond).footprints(), (2.0, 2.0), 0.3)
