from collections import Counter

import numpy as np

from coral.advisor.question import Rejection
from coral.reef.decide.baselines import baseline_rules

FACTS = {
    "centroids": [
        {"index": 0, "visited": True, "path_m": 1.0},
        {"index": 1, "visited": False, "path_m": 2.0},
        {"index": 2, "visited": False, "path_m": 9.0},
        {"index": 3, "visited": False, "path_m": None},
        {"index": 4, "visited": False, "path_m": 30.0},
    ],
    "options": [{"forward_m": f, "left_m": s} for f in (-2, 1, 3) for s in (-1, 2)],
}


def draw(kind, seed=0, refused=(), count=600):
    rule = baseline_rules("random", np.random.default_rng(seed))[kind]
    rejections = [Rejection(code="no", reason="no", details=details) for details in refused]
    return [rule(FACTS, rejections) for _ in range(count)]


def test_chance_gives_every_open_cluster_the_same_share():
    shares = Counter(answer.selected_centroid_index for answer in draw("reef-centroid"))
    assert set(shares) == {1, 2, 4}
    assert min(shares.values()) > 150


def test_chance_gives_every_waypoint_the_same_share():
    shares = Counter((answer.forward_m, answer.left_m) for answer in draw("reef-waypoint"))
    assert len(shares) == 6
    assert min(shares.values()) > 60


def test_what_was_refused_is_not_drawn_again():
    assert {a.selected_centroid_index for a in draw("reef-centroid", refused=[{"index": 1}, {"index": 4}])} == {2}
    left = {(a.forward_m, a.left_m) for a in draw("reef-waypoint", refused=[{"forward_m": 1, "left_m": 2}])}
    assert len(left) == 5
    assert (1, 2) not in left


def test_the_same_seed_draws_the_same_lots():
    again = [a.selected_centroid_index for a in draw("reef-centroid", seed=3, count=20)]
    assert again == [a.selected_centroid_index for a in draw("reef-centroid", seed=3, count=20)]
    assert again != [a.selected_centroid_index for a in draw("reef-centroid", seed=4, count=20)]


def test_a_constant_advisor_says_the_same_whatever_it_is_shown():
    rules = baseline_rules("constant")
    assert rules["reef-centroid"](FACTS, []).selected_centroid_index == 0
    step = rules["reef-waypoint"](FACTS, [Rejection(code="no", reason="no")])
    assert (step.forward_m, step.left_m) == (5, 0)
