from itertools import islice, pairwise

import numpy as np
import pytest

from coral.exam.reef_moments import moments
from coral.exam.reef_regret import INSPECTED_M, TrueReef
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.geometry import to_world

CHOSEN = 3


@pytest.fixture(scope="module")
def reef():
    world = generate(GeneratorCfg(topology="L", size_m=(12.0, 12.0), clusters=3, seed=1))
    return world, TrueReef(world).clusters


@pytest.fixture(scope="module")
def way(reef):
    """The first moments of a way through a small reef."""
    world, clusters = reef
    return list(islice(moments(world, clusters, np.random.default_rng(0), INSPECTED_M), CHOSEN))


def test_dots_and_waypoints_are_asked_for(way):
    assert {moment.question.kind for moment in way} == {"reef-centroid", "reef-waypoint"}
    assert all(moment.question.prompt and moment.question.pictures for moment in way)


def test_time_goes_on_and_what_was_inspected_is_not_left(reef, way):
    _, clusters = reef
    for before, after in pairwise(way):
        assert after.question.asked_at_s > before.question.asked_at_s
        assert set(after.left) <= set(before.left)
    for moment in way:
        away = np.hypot(*(clusters[list(moment.left)] - moment.pose[:2]).T)
        assert (away > INSPECTED_M).all()


def test_a_waypoint_is_the_point_that_far_from_the_robot(way):
    asked = [one for one in way if one.question.kind == "reef-waypoint"]
    for moment in asked:
        points = {answer: point for answer, point in moment.options.items() if not isinstance(point, str)}
        assert points
        for answer, point in points.items():
            forward, left = map(int, answer.split(","))
            assert point == pytest.approx(to_world(moment.pose, forward, left))


def test_a_dot_leads_to_a_cluster_that_is_left_and_a_visited_one_is_refused(reef, way):
    _, clusters = reef
    moment = next(one for one in way if one.question.kind == "reef-centroid")
    shown = {str(one["index"]): one for one in moment.question.facts["centroids"]}
    assert set(moment.options) == set(shown)
    for index, goal in moment.options.items():
        if shown[index]["visited"]:
            assert goal == "visited"
    points = [point for point in moment.options.values() if not isinstance(point, str)]
    assert points
    for point in points:
        assert np.hypot(*(clusters[list(moment.left)] - point).T).min() < INSPECTED_M


def test_the_same_seed_leads_the_same_way(reef, way):
    world, clusters = reef
    (again,) = islice(moments(world, clusters, np.random.default_rng(0), INSPECTED_M), 1)
    assert again == way[0]
