import math

import pytest

from coral.advisor.question import Rejection
from coral.reef.decide.heuristic import choose_centroid, choose_waypoint


def centroid(index, forward, left, **changes):
    return {
        "index": index,
        "forward_m": forward,
        "left_m": left,
        "path_m": math.hypot(forward, left),
        "visited": False,
        "inspected": 0.0,
        "left_m2": 0.5,
        "failed_attempts": 0,
        "unexplored": 0.3,
        **changes,
    }


def facts(centroids=(), frontiers=(), options=()):
    return {"centroids": list(centroids), "frontiers": list(frontiers), "options": list(options)}


def frontier(forward, left, **changes):
    return {
        "forward_m": forward,
        "left_m": left,
        "path_m": math.hypot(forward, left),
        "length_m": 2.0,
        "unexplored": 0.5,
        "reef_m": 2.0,
        **changes,
    }


GRID = [
    {"forward_m": f, "left_m": s, "path_m": math.hypot(f, s), "unexplored": 0.2}
    for f in range(-6, 7)
    for s in range(-6, 7)
    if f or s
]


def test_clusters_that_are_done_are_avoided():
    answer = choose_centroid(facts([centroid(0, 3.0, 0.0, visited=True), centroid(1, 6.0, 0.0)]), ())
    assert answer.selected_centroid_index == 1


def test_a_doubtful_cluster_is_worth_no_visit():
    answer = choose_centroid(facts([centroid(0, 3.0, 0.0, doubtful=True), centroid(1, 6.0, 0.0)]), ())
    assert answer.selected_centroid_index == 1


def test_of_two_clusters_at_one_distance_the_one_with_more_to_see_comes_first():
    answer = choose_centroid(facts([centroid(0, 4.0, 3.0, left_m2=0.1), centroid(1, 4.0, -3.0, left_m2=2.0)]), ())
    assert answer.selected_centroid_index == 1


def test_turning_counts_as_way():
    answer = choose_centroid(facts([centroid(0, -3.5, 0.0), centroid(1, 4.0, 0.0)]), ())
    assert answer.selected_centroid_index == 1
    assert choose_centroid(facts([centroid(0, -3.0, 0.0)]), ()).selected_centroid_index == 0


def test_a_near_cluster_is_not_left_behind_for_a_far_one():
    answer = choose_centroid(facts([centroid(7, 9.0, 0.0, left_m2=1.0), centroid(2, 2.0, 1.0)]), ())
    assert answer.selected_centroid_index == 2
    assert answer.then == (7,)


def test_the_goals_after_it_follow_the_tour():
    dots = [centroid(0, 3.0, 0.0), centroid(1, 9.0, 0.0), centroid(2, 6.0, 0.0), centroid(3, 12.0, 0.0)]
    answer = choose_centroid(facts(dots), ())
    assert (answer.selected_centroid_index, answer.then) == (0, (2, 1))


def test_a_refused_cluster_is_not_named_again():
    refused = Rejection(code="regret", reason="", details={"index": 1})
    answer = choose_centroid(facts([centroid(1, 4.0, 0.0), centroid(2, 7.0, 0.0)]), [refused])
    assert answer.selected_centroid_index == 2


def test_a_goal_that_failed_is_put_off():
    answer = choose_centroid(facts([centroid(0, 4.0, 0.0, failed_attempts=1), centroid(1, 5.0, 1.0)]), ())
    assert answer.selected_centroid_index == 1


def test_without_clusters_the_index_is_null():
    assert choose_centroid(facts(), ()).selected_centroid_index is None


def test_waypoint_makes_for_the_frontier():
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)], options=GRID), ())
    assert (answer.forward_m, answer.left_m) == (5, 1)


def test_waypoint_keeps_to_the_reef():
    near, far = frontier(5.0, 2.0, reef_m=3.0), frontier(5.0, -2.0, reef_m=12.0)
    answer = choose_waypoint(facts(frontiers=[far, near], options=GRID), ())
    assert answer.left_m > 0


def test_further_waypoints_are_named_only_where_the_step_reaches_its_place():
    in_reach = [frontier(4.0, 0.0), frontier(4.0, 5.0)]
    assert [(s.forward_m, s.left_m) for s in choose_waypoint(facts(frontiers=in_reach, options=GRID), ()).then] == [
        (4, 5)
    ]
    out_of_reach = [frontier(15.0, 0.0), frontier(15.0, 6.0)]
    assert choose_waypoint(facts(frontiers=out_of_reach, options=GRID), ()).then == ()


def test_a_refused_waypoint_is_not_named_again():
    refused = [Rejection(code="regret", reason="", details={"forward_m": 5, "left_m": 1})]
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)], options=GRID), refused)
    assert (answer.forward_m, answer.left_m) != (5, 1)


def test_nothing_in_reach_is_said():
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)]), ())
    assert (answer.forward_m, answer.left_m) == (0, 0)


def test_after_a_refusal_another_direction_is_named():
    refused = [Rejection(code="deviation", reason="", details={"forward_m": 5, "left_m": 1})]
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)], options=GRID), refused)
    assert abs(math.atan2(answer.left_m, answer.forward_m) - math.atan2(1, 5)) >= 0.5


@pytest.mark.parametrize(("visited", "rest"), [(True, True), (False, False)])
def test_the_rest_is_left_to_the_robot_when_no_dot_is_left(visited, rest):
    known = [centroid(0, 2.0, 0.0, visited=visited)]
    assert choose_waypoint(facts(known, [frontier(5.0, 0.0)], GRID), []).explore_rest == rest
