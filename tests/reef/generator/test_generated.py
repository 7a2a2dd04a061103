"""The forty generated reefs; that all clusters are within reach is proved by the generator, which refuses others."""

import itertools
import math
from collections import Counter

import numpy as np
import pytest

from coral.reef.generator.generated import COUNT, GENERATED, generated
from coral.reef.world.reachability import unreachable_clusters
from coral.reef.world.world import ReefWorld


@pytest.fixture(scope="module", params=[5, pytest.param(1, marks=pytest.mark.slow)])
def worlds(request) -> dict[str, ReefWorld]:
    """Every fifth of them, and all in the slow tests."""
    return {name: generated(name) for name in list(GENERATED)[:: request.param]}


def circles(world: ReefWorld) -> np.ndarray:
    """x, y and radius of the circle about every obstacle's outline."""
    return np.array(
        [(o.x, o.y, math.hypot(*o.size[:2]) if o.shape == "box" else max(o.size[:2])) for o in world.obstacles]
    )


def test_there_are_forty_of_30_to_60_m(worlds):
    assert len(GENERATED) == COUNT == 40
    assert {edge for cfg in GENERATED.values() for edge in cfg.size_m} >= {30.0, 60.0}
    assert all(30.0 <= edge <= 60.0 for cfg in GENERATED.values() for edge in cfg.size_m)
    kinds = Counter(cfg.topology for cfg in GENERATED.values())
    assert min(kinds[kind] for kind in ("branching", "looping", "patchy")) >= 10
    assert all(len(world.clusters) >= 9 for world in worlds.values())


def test_passages_are_80_cm_wide_and_there_are_many_such(worlds):
    for name, world in worlds.items():
        found = circles(world)
        gaps = np.hypot(*(found[:, None, :2] - found[None, :, :2]).transpose(2, 0, 1))
        gaps -= found[:, None, 2] + found[None, :, 2]
        near = gaps[np.triu_indices(len(found), 1)]
        assert near.min() >= 0.797, name  # places and sizes are kept to the millimetre
        assert (near < 0.92).sum() >= 8, name


def test_every_cluster_is_within_reach_of_the_hull(worlds):
    assert [name for name in list(worlds)[:2] if unreachable_clusters(worlds[name])] == []


def test_branching_reefs_branch(worlds):
    for world in (w for w in worlds.values() if w.topology == "branching"):
        trunk, *branches = (np.array(line) for line in world.spine)
        assert len(branches) >= 2
        for k, branch in enumerate(branches):
            parents = np.concatenate([trunk, *branches[:k]])
            assert np.hypot(*(parents - branch[0]).T).min() < 0.01
            assert np.hypot(*(parents - branch[-1]).T).min() > 1.5


def test_looping_reefs_close(worlds):
    for world in (w for w in worlds.values() if w.topology == "looping"):
        closed = [line for line in world.spine if line[0] == line[-1]]
        assert closed
        lengths = [sum(math.dist(a, b) for a, b in itertools.pairwise(line)) for line in closed]
        assert max(lengths) > world.size_m[0]


def test_patches_are_farther_apart_than_the_map_reaches(worlds):
    for world in (w for w in worlds.values() if w.topology == "patchy"):
        lines = [np.array(line) for line in world.spine]
        assert len(lines) >= 4
        for k, line in enumerate(lines):
            others = np.concatenate([other for i, other in enumerate(lines) if i != k])
            away = np.hypot(*(line[:, None] - others[None]).transpose(2, 0, 1)).min()
            assert away > (6.0 if world.size_m[0] >= 30.0 else 0.0)
