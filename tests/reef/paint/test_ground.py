"""The sea floor around solids: shadows where the sun says, debris around oysters."""

import math

import numpy as np
import pytest

from coral.reef.paint.ground import SeaFloor
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

SUN = (math.sin(0.5), 0.0, math.cos(0.5))
"""Leaning towards +x: shadows fall towards -x."""


def scene(*obstacles):
    oyster = Oyster(x=10.0, y=10.0, z=0.03, radii=(0.1, 0.1, 0.05))
    clusters = (Cluster(name="c", oysters=(oyster,)),)
    return Scene.from_world(
        ReefWorld(name="w", size_m=(20, 20), start=Start(x=1, y=1), clusters=clusters, obstacles=obstacles)
    )


def at(ground, x, y):
    j, i = round((x - ground.origin[0]) / ground.cell_m), round((y - ground.origin[1]) / ground.cell_m)
    return ground.values[i, j] / 255.0


@pytest.mark.parametrize(
    ("shape", "size"),
    [("cylinder", (0.3, 0.3, 1.0)), ("box", (0.3, 0.3, 1.0)), ("ellipsoid", (0.3, 0.3, 1.0)), ("sphere", (0.4,) * 3)],
)
def test_a_shadow_falls_away_from_the_sun(shape, size):
    height = 1.0
    ground = SeaFloor.of(scene(Obstacle(shape=shape, x=5.0, y=5.0, z=height, size=size)), SUN)
    away = height * math.tan(0.5)
    assert at(ground, 5.0 - away, 5.0)[0] < 0.01
    assert at(ground, 5.0 + away, 5.0)[0] > 0.99
    assert at(ground, 5.0 - away, 6.0)[0] > 0.99


def test_the_shadow_of_a_low_post_ends_where_its_top_hides_the_sun_no_more():
    post = Obstacle(shape="cylinder", x=5.0, y=5.0, z=0.5, size=(0.2, 0.2, 0.5))
    ground = SeaFloor.of(scene(post), SUN, softness=0.01)
    end = 5.0 - 1.0 * math.tan(0.5) - 0.2
    assert at(ground, end + 0.1, 5.0)[0] < 0.05
    assert at(ground, end - 0.1, 5.0)[0] > 0.95


def test_less_of_the_sky_is_seen_near_an_obstacle():
    ground = SeaFloor.of(scene(Obstacle(shape="box", x=5.0, y=5.0, z=1.0, size=(0.3, 0.3, 1.0))), SUN)
    near, far = at(ground, 5.35, 5.0)[1], at(ground, 7.5, 5.0)[1]
    assert near < 0.6
    assert far > 0.9


def test_debris_lies_around_oysters_only():
    ground = SeaFloor.of(scene(Obstacle(shape="box", x=5.0, y=5.0, z=1.0, size=(0.3, 0.3, 1.0))), SUN)
    assert at(ground, 10.1, 10.0)[2] > at(ground, 10.4, 10.0)[2] > 0.0
    assert at(ground, 5.4, 5.0)[2] == 0.0


def test_a_large_world_gets_larger_cells():
    wide = SeaFloor.of(scene(Obstacle(shape="box", x=900.0, y=900.0, z=1.0, size=(0.3, 0.3, 1.0))), SUN)
    assert wide.values[..., 0].size < 2_100_000
    assert wide.cell_m > 0.5
    assert np.isfinite(wide.values).all()
