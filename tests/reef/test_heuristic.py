from coral.advisor.question import Rejection
from coral.reef.heuristic import choose_centroid, choose_waypoint

HERE = {"forward_m": 0.0, "left_m": 0.0, "heading_deg": 0.0}


def centroid(index, forward, left, **changes):
    distance = (forward**2 + left**2) ** 0.5
    return {
        "index": index,
        "forward_m": forward,
        "left_m": left,
        "path_m": distance,
        "visited": False,
        "failed_attempts": 0,
        "unexplored": 0.3,
        "bearing_deg": 0.0,
        **changes,
    }


def facts(centroids=(), frontiers=(), options=(), arrival=HERE, trend=None, dead_end=False):
    return {
        "centroids": list(centroids),
        "frontiers": list(frontiers),
        "options": list(options),
        "arrival": arrival,
        "trend_deg": trend,
        "dead_end": dead_end,
    }


def frontier(forward, left, **changes):
    return {
        "forward_m": forward,
        "left_m": left,
        "path_m": (forward**2 + left**2) ** 0.5,
        "bearing_deg": 0.0,
        "length_m": 2.0,
        "unexplored": 0.5,
        "reef_m": 2.0,
        **changes,
    }


GRID = [
    {"forward_m": f, "left_m": s, "path_m": (f * f + s * s) ** 0.5, "unexplored": 0.2}
    for f in range(-6, 7)
    for s in range(-6, 7)
    if f or s
]


def test_visited_clusters_are_avoided():
    answer = choose_centroid(facts([centroid(0, 3.0, 0.0, visited=True), centroid(1, 6.0, 0.0)]), ())
    assert answer.selected_centroid_index == 1


def test_clusters_near_unexplored_water_are_preferred():
    answer = choose_centroid(facts([centroid(0, 4.0, 1.0, unexplored=0.0), centroid(1, 4.0, -1.0, unexplored=0.6)]), ())
    assert answer.selected_centroid_index == 1


def test_clusters_behind_wait_while_there_is_one_ahead():
    answer = choose_centroid(facts([centroid(0, -3.0, 0.0), centroid(1, 6.0, 0.0)]), ())
    assert answer.selected_centroid_index == 1
    assert choose_centroid(facts([centroid(0, -3.0, 0.0)]), ()).selected_centroid_index == 0


def test_a_refused_cluster_is_not_named_again():
    refused = Rejection(code="deviation", reason="", details={"index": 1})
    answer = choose_centroid(facts([centroid(1, 4.0, 0.0), centroid(2, 7.0, 0.0)]), [refused])
    assert answer.selected_centroid_index == 2


def test_a_cluster_that_will_be_reached_before_the_answer_is_skipped():
    arrival = {"forward_m": 3.0, "left_m": 0.0, "heading_deg": 0.0}
    answer = choose_centroid(facts([centroid(0, 3.5, 0.5), centroid(1, 7.0, 0.0)], arrival=arrival), ())
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


def test_waypoint_follows_the_trend_unless_at_a_dead_end():
    aside = [frontier(0.0, 5.0)]
    answer = choose_waypoint(facts(frontiers=aside, options=GRID, trend=0.0), ())
    assert answer.forward_m > 0
    answer = choose_waypoint(facts(frontiers=aside, options=GRID, trend=0.0, dead_end=True), ())
    assert (answer.forward_m, answer.left_m) == (0, 5)


def test_a_refused_waypoint_is_not_named_again():
    refused = [Rejection(code="deviation", reason="", details={"forward_m": 5, "left_m": 1})]
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)], options=GRID), refused)
    assert (answer.forward_m, answer.left_m) != (5, 1)


def test_nothing_in_reach_is_said():
    answer = choose_waypoint(facts(frontiers=[frontier(5.0, 1.0)]), ())
    assert (answer.forward_m, answer.left_m) == (0, 0)
