"""Generated reefs: the ten shipped ones, and what a person may ask for."""

import math
from dataclasses import replace

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.generator.generate import SHIPPED, GeneratorCfg, command_line, generate
from coral.reef.generator.spines import EVERY_TOPOLOGY
from coral.reef.map.chain import ChainCfg, components
from coral.reef.simulation.coverage import rasterise
from coral.reef.world.reachability import distance_to, obstacle_outline
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld, load_world, save_world
from coral.reef.world.world_names import WORLDS_DIR

CELL_M = 0.05


@pytest.fixture(scope="module", params=SHIPPED)
def world(request) -> ReefWorld:
    return load_world(request.param)


def beds(world: ReefWorld) -> list[np.ndarray]:
    """Cells (m) under the oysters of every cluster."""
    scene = Scene.from_world(world)
    return [
        rasterise(scene.outlines(np.flatnonzero(scene.cluster == k)), CELL_M, 0.0) for k in range(len(world.clusters))
    ]


def gaps(world: ReefWorld) -> list[float]:
    """Distance (m) of every obstacle's outline to the nearest other one."""
    outlines = [obstacle_outline(obstacle, corners=24) for obstacle in world.obstacles]
    places = np.array([(o.x, o.y) for o in world.obstacles])
    away = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    return [
        min(min(distance_to(outlines[k], *corner) for corner in outlines[i]) for k in np.argsort(away[i])[1:4])
        for i in range(len(outlines))
    ]


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_files_are_what_the_generator_makes(name, tmp_path):
    cfg = SHIPPED[name]
    world, made_by = generate(cfg, name), f"Made by: {command_line(cfg, f'{name}.yaml')}"
    head = f"{name}: {cfg.topology}-shaped reef. World frame ENU, z up; metres and radians."
    save_world(world, tmp_path / "w.yaml", f"{head}\n{made_by}")
    assert (tmp_path / "w.yaml").read_bytes() == (WORLDS_DIR / f"{name}.yaml").read_bytes()
    assert load_world(name) == world


def test_sizes_and_counts(world):
    assert all(20.0 <= edge <= 30.0 for edge in world.size_m)  # paper IV-A
    assert 6 <= len(world.clusters) <= 9
    assert 50 <= len(world.obstacles) <= 80
    assert all(30 <= len(cluster.oysters) <= 110 for cluster in world.clusters)
    assert math.hypot(world.current.x_m_s, world.current.y_m_s) <= 0.081


def test_every_cluster_is_one_patch_clear_of_the_others(world):
    cells = beds(world)
    mask = np.zeros([math.ceil(edge / CELL_M) for edge in world.size_m[::-1]], bool)
    for bed in cells:
        mask[(bed[:, 1] / CELL_M).astype(int), (bed[:, 0] / CELL_M).astype(int)] = True
        assert len(bed) * CELL_M**2 > 0.6
    assert len(components(mask, CELL_M, ChainCfg())) == len(cells)
    for k, bed in enumerate(cells):
        others = np.concatenate([other for i, other in enumerate(cells) if i != k])
        low, high = bed.min(axis=0) - 1.2, bed.max(axis=0) + 1.2
        near = others[((others > low) & (others < high)).all(axis=1)]
        if len(near):
            assert np.hypot(*(bed[:, None] - near[None]).transpose(2, 0, 1)).min() >= 1.2


def test_the_next_cluster_is_within_the_range_of_the_map(world):
    middles = np.array([bed.mean(axis=0) for bed in beds(world)])
    away = np.hypot(*(middles[:, None] - middles[None]).transpose(2, 0, 1)) + 99.0 * np.eye(len(middles))
    assert away.min() >= 2.9
    assert away.min(axis=1).max() <= 6.5
    assert (middles.min(axis=0) > 1.8).all()
    assert (middles.max(axis=0) < np.array(world.size_m) - 1.8).all()


def test_passages_let_the_hull_through_and_are_narrow(world):
    passages = gaps(world)
    assert min(passages) >= 0.99
    assert np.median(passages) <= 1.5


def test_obstacles_are_densest_before_the_start(world):
    start = np.array([world.start.x, world.start.y])
    places = np.array([(o.x, o.y) for o in world.obstacles])
    ahead = np.array([math.cos(world.start.theta), math.sin(world.start.theta)])
    field = (np.hypot(*(places - start).T) <= 6.5) & ((places - start) @ ahead >= -0.1)
    density = field.sum() / (0.5 * math.pi * 6.5**2)
    assert field.sum() >= 18
    assert density > 1.5 * (~field).sum() / np.prod(world.size_m)
    assert min(distance_to(obstacle_outline(o), *start) for o in world.obstacles) >= 0.7


def test_obstacles_stand_on_the_seabed_and_reach_above_the_camera(world):
    assert all(o.z - o.size[2] <= 1e-9 and o.z + o.size[2] >= 1.2 for o in world.obstacles)


def test_no_obstacle_stands_on_an_oyster(world):
    oysters = np.array([(o.x, o.y) for cluster in world.clusters for o in cluster.oysters])
    for obstacle in world.obstacles:
        near = oysters[np.hypot(*(oysters - (obstacle.x, obstacle.y)).T) < 1.5]
        assert all(distance_to(obstacle_outline(obstacle), x, y) > 0.3 for x, y in near)


def test_prongs_of_the_e_are_dead_ends_far_apart():
    for name in ("e1", "e2"):
        world = load_world(name)
        prongs = sorted(line[0][1] for line in world.spine[1:])
        assert len(prongs) == 3
        assert min(np.diff(prongs)) >= 5.0


@pytest.mark.parametrize("topology", EVERY_TOPOLOGY)
def test_same_seed_same_reef_other_seed_another(topology):
    bare = GeneratorCfg(topology=topology, seed=3, dense_obstacles=4, obstacles=6)
    first = generate(bare)
    assert generate(bare) == first
    assert generate(replace(bare, seed=4)).clusters != first.clusters


@pytest.mark.parametrize("topology", EVERY_TOPOLOGY)
def test_defaults_fit_for_any_seed(topology):
    for seed in (100, 101):
        world = generate(GeneratorCfg(topology=topology, seed=seed))
        assert (len(world.clusters), len(world.obstacles)) == (7, 54)


def test_a_reef_grows_along_a_drawn_line():
    world = generate(
        GeneratorCfg(spine=(((3.0, 3.0), (12.0, 4.0), (15.0, 12.0)),), clusters=4, size_m=(20.0, 16.0)), "mine"
    )
    assert (world.name, world.topology) == ("mine", "custom")
    assert (world.start.x, world.start.y) == (3.0, 3.0)
    assert world.start.theta == pytest.approx(math.atan2(1.0, 9.0), abs=1e-3)
    assert len(world.clusters) == 4
    assert math.hypot(world.clusters[-1].oysters[0].x - 15.0, world.clusters[-1].oysters[0].y - 12.0) < 1.6


@pytest.mark.parametrize(
    ("changes", "flag", "words"),
    [
        ({"topology": "Q"}, "--topology", "one of L, S, K, E, O"),
        ({"size_m": (math.nan, 20.0)}, "--size-m", "8 to 100 m"),
        ({"clusters": 3, "topology": "E"}, "--clusters", "4 (one for each line"),
        ({"clusters": 40}, "--clusters", "at most 11"),
        ({"oysters": (5, 2)}, "--oysters", "range"),
        ({"dense_obstacles": 100}, "--dense-obstacles", "at most"),
        ({"obstacles": 300}, "--obstacles", "at most"),
        ({"passage_m": 0.5}, "--passage-m", "0.8 to 5 m"),
        ({"seed": -1}, "--seed", "0 or more"),
        ({"spine": (((3.0, 3.0),),)}, "--polyline", "at least 2 points"),
        ({"spine": (((3.0, 3.0), (3.0, 3.0)),)}, "--polyline", "longer than"),
        ({"spine": (((3.0, 3.0), (40.0, 3.0)),)}, "--polyline", "inside --size-m"),
    ],
)
def test_impossible_demands_are_named(changes, flag, words):
    with pytest.raises(InputError) as caught:
        generate(GeneratorCfg(**changes))
    assert caught.value.where == flag
    assert words in caught.value.expected
