import heapq
import math

import cv2
import numpy as np
import pytest
from given_fields import field_to

from coral.reef.map.costfield import NO_FREE_CELL, UNREACHABLE, CostField, CostFieldCfg, slowness_over
from coral.reef.map.costfield_kernels import lookup, march

CELL = 0.05


def distance_of(obstacle):
    return cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL)


def walled(gap=None):
    """10 x 10 m with a wall at x = 5 m, open at y in `gap` (m)."""
    obstacle = np.zeros((200, 200), np.uint8)
    obstacle[:, 100:102] = 1
    if gap:
        obstacle[round(gap[0] / CELL) : round(gap[1] / CELL), 100:102] = 0
    return distance_of(obstacle)


def heap_march(slowness, cell, j0, i0, gx, gy):
    """Twin of `march`: the same stencil with an exact priority queue, in plain Python."""
    h, w = slowness.shape
    value, done, heap = np.full((h, w), np.inf), np.zeros((h, w), bool), []
    for j in range(j0 - 1, j0 + 2):
        for i in range(i0 - 1, i0 + 2):
            if 0 <= j < h and 0 <= i < w and slowness[j, i] > 0:
                value[j, i] = slowness[j, i] * math.hypot((i + 0.5) * cell - gx, (j + 0.5) * cell - gy)
                heapq.heappush(heap, (value[j, i], j, i))
    while heap:
        _, j, i = heapq.heappop(heap)
        if done[j, i]:
            continue
        done[j, i] = True
        for y, x in ((j + 1, i), (j - 1, i), (j, i + 1), (j, i - 1)):
            if not (0 <= y < h and 0 <= x < w) or done[y, x] or slowness[y, x] < 0:
                continue
            a = min(value[y, x - 1] if x else np.inf, value[y, x + 1] if x + 1 < w else np.inf)
            b = min(value[y - 1, x] if y else np.inf, value[y + 1, x] if y + 1 < h else np.inf)
            f, low, high = slowness[y, x] * cell, min(a, b), max(a, b)
            new = low + f if high - low >= f else 0.5 * (low + high + math.sqrt(2 * f * f - (high - low) ** 2))
            if new < value[y, x]:
                value[y, x] = new
                heapq.heappush(heap, (new, y, x))
    return value


def test_marching_with_buckets_matches_an_exact_queue():
    rng = np.random.default_rng(3)
    slowness = (1.0 + 3.0 * rng.random((40, 50)) ** 4).astype(np.float32)
    slowness[rng.random((40, 50)) < 0.15] = -1.0
    slowness[20, 25] = 1.0
    fast = march(slowness, 0.1, 20, 25, 2.55, 2.05, 4.0)
    slow = heap_march(slowness, 0.1, 20, 25, 2.55, 2.05)
    assert np.array_equal(np.isfinite(fast), np.isfinite(slow))
    reached = np.isfinite(slow)
    assert np.abs(fast[reached] - slow[reached]).max() < 0.02 * slow[reached].max()
    assert reached.sum() > 1000


def test_open_water_is_the_straight_distance():
    field = field_to((5.03, 4.97), np.full((200, 200), np.inf, np.float32), start=(1.0, 1.0))
    assert field.ok
    for x, y in ((2.0, 2.0), (5.0, 8.5), (8.7, 5.2)):
        assert field.lookup(x, y) == pytest.approx(math.hypot(x - 5.03, y - 4.97), rel=0.05)


def test_a_wall_is_gone_around():
    straight = field_to((8.0, 2.0), walled(gap=(0.0, 10.0)))
    around = field_to((8.0, 2.0), walled(gap=(7.0, 9.0)), start=(2.0, 2.0))
    assert straight.lookup(2.0, 2.0) == pytest.approx(6.0, rel=0.03)
    # by hand: (2,2) to (5,8-0.65) and on to (8,2) is 12.2 m at least, the gap's middle 13.4 m
    assert 12.0 < around.lookup(2.0, 2.0) < 14.5
    path = around.path_from(2.0, 2.0)
    assert path[0] == pytest.approx([2.0, 2.0])
    assert path[-1] == pytest.approx([8.0, 2.0])
    crossing = path[np.argmin(np.abs(path[:, 0] - 5.0))]
    assert 7.35 < crossing[1] < 8.65
    distance = walled(gap=(7.0, 9.0))
    assert min(distance[int(y / CELL), int(x / CELL)] for x, y in path) > 0.3


def test_the_soft_band_keeps_paths_away_from_obstacles():
    obstacle = np.zeros((200, 200), np.uint8)
    cv2.circle(obstacle, (100, 101), 10, 1, -1)
    distance = distance_of(obstacle)
    clear = []
    for penalty in (0.0, 3.0):
        field = field_to((9.0, 5.0), distance, cfg=CostFieldCfg(penalty=penalty))
        path = field.path_from(1.0, 5.0)
        clear.append(min(distance[int(y / CELL), int(x / CELL)] for x, y in path))
    assert clear[1] > clear[0] + 0.15


def test_no_way_is_a_named_failure():
    field = field_to((8.0, 2.0), walled(), start=(2.0, 2.0))
    assert not field.ok
    assert field.failure == UNREACHABLE
    assert not field.reaches(2.0, 2.0)
    assert field.reaches(7.0, 8.0)
    blocked = field_to((1.0, 1.0), np.zeros((40, 40), np.float32))
    assert blocked.failure == NO_FREE_CELL


def test_a_goal_inside_an_obstacle_moves_to_the_nearest_free_cell():
    field = field_to((5.05, 2.0), walled(gap=(7.0, 9.0)), start=(2.0, 2.0))
    assert field.ok
    assert field.goal == (5.05, 2.0)
    assert field.target != field.goal
    assert math.dist(field.target, field.goal) < 0.55
    assert field.path_from(2.0, 2.0)[-1] == pytest.approx(field.target)


def test_the_edge_of_the_map_is_blocked():
    slowness = slowness_over(np.full((100, 100), np.inf, np.float32), CELL, CostFieldCfg())
    assert (slowness[0] < 0).all()
    assert (slowness[:, :3] < 0).all()
    assert slowness[25, 25] == 1.0
    assert slowness[25, 4] > 2.5


def test_inside_the_blocked_band_the_way_leads_out():
    field = field_to((2.0, 2.0), walled(gap=(7.0, 9.0)), start=(4.8, 2.0))
    assert field.ok
    assert field.lookup(4.5, 3.0) < field.lookup(4.8, 3.0)
    assert np.isfinite(field.value).all()


def test_lookup_is_bilinear_with_its_gradient():
    x, y = (np.arange(30) + 0.5) * 0.1, (np.arange(20) + 0.5) * 0.1
    value = (2.0 * x[None, :] - 3.0 * y[:, None] + 1.0).astype(np.float32)
    assert lookup(value, 0.1, 1.234, 0.777) == pytest.approx((2 * 1.234 - 3 * 0.777 + 1, 2.0, -3.0), abs=1e-4)


def test_a_straight_field_ignores_the_map():
    field = CostField.straight((200, 200), (8.0, 2.0))
    assert field.ok
    assert field.reaches(2.0, 2.0)
    assert field.lookup(2.0, 2.0) == pytest.approx(6.0, abs=0.01)


def test_lengths_of_many_ways_are_those_of_one_at_a_time():
    obstacle = np.zeros((200, 200), np.uint8)
    obstacle[:, 90:94] = 1
    field = field_to((2.0, 5.0), distance_of(obstacle))
    xs, ys = np.random.default_rng(5).uniform(-0.5, 10.5, (2, 200))
    single = [field.lookup(x, y) if field.reaches(x, y) else math.inf for x, y in zip(xs, ys, strict=True)]
    assert 20 < np.isinf(single).sum() < 180
    assert field.lengths(xs, ys).tolist() == single
    assert np.all(np.isfinite(CostField.straight((200, 200), (2.0, 5.0)).lengths(xs, ys)))


def scattered(size_m, seed, wall=False):
    """Slowness of a square map of 0.1 m cells with round obstacles, and a wall with a gap near the edge of it."""
    n, rng = round(size_m / 0.1), np.random.default_rng(seed)
    obstacle = np.zeros((n, n), np.uint8)
    for _ in range(n // 8):
        cv2.circle(obstacle, tuple(int(a) for a in rng.integers(0, n, 2)), int(rng.integers(2, 8)), 1, -1)
    if wall:
        obstacle[: n - 30, n // 2 : n // 2 + 3] = 1
    distance = cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(0.1)
    return slowness_over(distance, 0.1, CostFieldCfg(ratio=1))


@pytest.mark.parametrize("wall", [False, True])
def test_a_window_is_as_good_as_the_whole_map_about_the_robot(wall):
    slowness, rng = scattered(60.0, 3, wall), np.random.default_rng(1)
    for _ in range(8):
        start, goal = rng.uniform(5.0, 55.0, (2, 2)).tolist()
        whole = CostField.over(slowness, goal, start=start)
        part = CostField.between(slowness, start, goal)
        assert part.failure == whole.failure
        if not whole.ok:
            continue
        around = [(start[0] + 3.0 * math.cos(a), start[1] + 3.0 * math.sin(a)) for a in np.arange(8.0)]
        near = [p for p in around if whole.reaches(*p) and whole.lookup(*p) < whole.lookup(*start) + 3.5]
        for x, y in (start, *near):
            assert part.lookup(x, y) == pytest.approx(whole.lookup(x, y), abs=1e-3)
        assert part.value.shape == whole.value.shape
        np.testing.assert_allclose(part.target, whole.target)


def test_a_search_that_takes_too_many_cells_is_not_done():
    slowness = scattered(60.0, 3)
    assert CostField.between(slowness, (5.0, 5.0), (55.0, 55.0), most_cells=40_000) is None
    assert CostField.between(slowness, (5.0, 5.0), (55.0, 55.0)) is not None
