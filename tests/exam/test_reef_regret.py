import itertools

import numpy as np
import pytest

from coral.exam.reef_regret import THINKING_S, TrueReef, shortest_path
from coral.reef.world.geometry import Pose
from coral.reef.world.world import load_world


def test_shortest_path_against_all_orders():
    rng = np.random.default_rng(3)
    places, points = rng.uniform(0, 10, (5, 2)), rng.uniform(0, 10, (4, 2))
    between = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    entry = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1))
    wanted = [
        min(
            entry[n, order[0]] + sum(between[a, b] for a, b in itertools.pairwise(order))
            for order in itertools.permutations(range(5))
        )
        for n in range(4)
    ]
    assert shortest_path(entry, between) == pytest.approx(wanted)


def test_going_the_wrong_way_costs_seconds():
    reef = TrueReef(load_world("l1"))
    near, far = reef.clusters[0], reef.clusters[-1]
    pose = Pose(float(near[0]), float(near[1]), 0.0)
    towards = pose[:2] + 0.5 * (far - near)
    costs = reef.seconds(pose, np.array([towards, reef.clusters[0]]), [len(reef.clusters) - 1])
    assert costs[0] < costs[1]
    assert costs[1] > THINKING_S  # whoever goes nowhere waits for the next answer
