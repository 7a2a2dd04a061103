"""Materials follow from what a solid is; shadows fall where the sun says; noise tiles have no seam."""

import math

import numpy as np
import pytest

from coral.reef.paint.surface_kernels import BLOCK, BUOY, CARD, PILE, ROCK, SHELL, TILE_PX
from coral.reef.paint.surfaces import FLAKES, GRAIN, PEBBLES, SMOOTH, Materials, SeaFloor, noise_tile
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

OYSTERS = tuple(Oyster(x=1.0 + k, y=1.0, z=0.03, radii=(0.1, 0.07, 0.05)) for k in range(20))
SHAPES = (
    ("sphere", (0.2, 0.2, 0.2), BUOY),
    ("ellipsoid", (0.4, 0.3, 0.2), ROCK),
    ("cylinder", (0.2, 0.2, 1.0), PILE),
    ("box", (0.2, 0.2, 0.2), BLOCK),
)
WORLD = ReefWorld(
    name="w",
    size_m=(30, 30),
    start=Start(x=25, y=25),
    clusters=(Cluster(name="c", oysters=OYSTERS),),
    obstacles=tuple(Obstacle(shape=shape, x=5 + k, y=5, z=1, size=size) for k, (shape, size, _) in enumerate(SHAPES)),
)
SUN = (math.sin(0.5), 0.0, math.cos(0.5))
"""Leaning towards +x: shadows fall towards -x."""


def test_oysters_are_shells_and_every_obstacle_has_its_own_material():
    chosen = Materials.of(Scene.from_world(WORLD), 3).kind
    assert chosen.tolist() == [SHELL] * 20 + [material for *_, material in SHAPES]


def test_no_two_oysters_are_alike():
    made = Materials.of(Scene.from_world(WORLD), 3)
    assert len(np.unique(made.paint[:20], axis=0)) == 20
    assert made.paint.min() > 0.0
    assert made.paint.max() < 1.0


def test_a_thing_has_the_look_of_its_kind_and_the_others_stay_as_they_were():
    net = {"name": "net", "kind": "tyre", "x": 20.0, "y": 20.0}
    plain = Materials.of(Scene.from_world(WORLD), 3)
    mixed = Materials.of(Scene.from_world(ReefWorld.model_validate({**WORLD.model_dump(), "things": [net]})), 3)
    assert mixed.kind[:20].tolist() == plain.kind[:20].tolist()
    assert set(mixed.kind[20:-4].tolist()) == {CARD}
    assert mixed.paint[20:-4].max() < 0.02


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


def level(k):
    n = TILE_PX >> k
    start = (4 * TILE_PX**2 - 4 * n**2) // 3
    return noise_tile(0)[start : start + n * n].reshape(n, n, 4) / 255.0


def test_all_levels_are_there_down_to_one_texel():
    assert noise_tile(0).shape == ((4 * TILE_PX**2 - 1) // 3, 4)
    np.testing.assert_allclose(level(9)[0, 0], level(0).mean(axis=(0, 1)), atol=4e-3)


def test_a_texel_is_the_mean_of_the_four_below():
    fine = level(0)
    np.testing.assert_allclose(level(1)[3, 5], fine[6:8, 10:12].mean(axis=(0, 1)), atol=4e-3)


def test_there_is_no_seam():
    """Across the edge neighbours differ as much as anywhere else."""
    fine = level(0)
    inside = np.abs(np.diff(fine, axis=0)).mean(axis=(0, 1))
    across = np.abs(fine[0] - fine[-1]).mean(axis=0)
    assert (across < 1.5 * inside).all()


def test_clouds_are_smoother_than_grain():
    fine = level(0)
    change = np.abs(np.diff(fine, axis=1)).mean(axis=(0, 1)) / fine.std(axis=(0, 1))
    assert change[SMOOTH] < 0.5 * change[GRAIN]


def test_most_of_a_tile_lies_between_its_bits():
    fine = level(0)
    for channel in (FLAKES, PEBBLES):
        assert 0.2 < (fine[..., channel] == 0.0).mean() < 0.9
