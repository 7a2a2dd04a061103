"""The paper's pool as worlds."""

import math

import pytest

from coral.errors import InputError
from coral.reef.generator.pool import BALLS, PASSAGE_M, RADIUS_M, SIZE_M, WATER_M, pool
from coral.reef.world.find_world import find_world
from coral.reef.world.world import check_world


@pytest.mark.parametrize("seed", range(10))
def test_a_pool_is_as_large_as_the_papers_and_all_of_it_lies_inside(seed):
    world = find_world(f"pool:{seed}")
    check_world(world, world.name)
    assert (2 * world.tank.radius_m, world.water_depth_m) == (pytest.approx(12 * 0.3048, abs=0.01), WATER_M)
    middle = 0.5 * SIZE_M
    shells = [oyster for cluster in world.clusters for oyster in cluster.oysters]
    assert all(math.hypot(o.x - middle, o.y - middle) < RADIUS_M for o in shells)
    assert len(world.obstacles) == BALLS
    for ball in world.obstacles:
        assert 0.0 < ball.z - ball.size[2] < ball.z + ball.size[2] < WATER_M
        assert math.hypot(ball.x - middle, ball.y - middle) + ball.size[0] < RADIUS_M - PASSAGE_M + 0.01


def test_the_seed_makes_the_pool():
    assert pool(3) == find_world("pool:3")
    pool.cache_clear()
    assert pool(3) == find_world("pool:3")
    assert len({find_world(f"pool:{k}").start for k in range(10)}) == 10
    assert len({len(find_world(f"pool:{k}").clusters) for k in range(4)}) == 2


@pytest.mark.parametrize("name", ["pool:", "pool:-1", "pool:x", "pool:1.5", "pool:9999999999"])
def test_another_name_is_one_line(name):
    with pytest.raises(InputError, match="pool:SEED"):
        find_world(name)
