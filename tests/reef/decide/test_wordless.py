"""Rules for missions in words that do not see what things are."""

from __future__ import annotations

from coral.reef.decide.wordless import BlindOrders, Wordless
from coral.reef.world.instruction import Answered, DoneBy, EndsAt, Inspected, KeptOff, Sides

KINDS = {"a": "tyre", "b": "tyre", "net": "ghost-net"}


def facts(*dots, at_s=10.0, home=(0.0, 0.0), frontiers=(), options=()):
    return {
        "mission": {"at_s": at_s, "time_s": 180.0, "home": {"forward_m": home[0], "left_m": home[1]}},
        "centroids": [{"index": k, "visited": visited, "path_m": path_m} for k, (path_m, visited) in enumerate(dots)],
        "frontiers": list(frontiers),
        "options": list(options),
    }


def test_conditions_are_told_without_their_kinds():
    conditions = (Inspected(of=("tyre",)), EndsAt(), DoneBy(time_s=100.0), Answered(right=("4",)))
    assert BlindOrders.of_conditions(conditions, KINDS) == BlindOrders(
        count=2, home=True, time_s=100.0, answers=("4",), counts=True
    )
    conditions = (Sides(of=("net",), count=3), KeptOff(of=("net",), distance_m=2.0))
    assert BlindOrders.of_conditions(conditions, KINDS) == BlindOrders(count=1, sides=3, off_m=2.0)


def test_key_words_are_read():
    words = "Find the net, keep 2 m away, photograph it from three sides and be home within 150 seconds."
    assert BlindOrders.of_words(words) == BlindOrders(count=1, sides=3, off_m=2.0, home=True, time_s=150.0)


def test_it_goes_to_the_nearest_dot_until_it_has_seen_as_many_as_it_was_told():
    rules = Wordless(BlindOrders(count=1))
    assert rules(facts((9.0, False), (4.0, False)), ()).selected_centroid_index == 1
    assert rules(facts((9.0, False), (4.0, True)), ()).done


def test_it_comes_home_in_time():
    rules = Wordless(BlindOrders(home=True, time_s=60.0))
    assert rules(facts((4.0, False), at_s=40.0, home=(-8.0, 0.0)), ()).home
    assert rules(facts((4.0, False), at_s=55.0), ()).done


def test_it_explores_where_no_dot_is_left():
    step = {"forward_m": 4, "left_m": 1, "path_m": 4.2, "unexplored": 0.5}
    front = {"forward_m": 5.0, "left_m": 1.0, "path_m": 5.0}
    answer = Wordless()(facts(frontiers=[front], options=[step]), ())
    assert (answer.waypoint.forward_m, answer.waypoint.left_m) == (4, 1)


def test_it_says_the_number_of_dots_where_a_number_is_asked_for():
    assert Wordless(BlindOrders(counts=True))(facts((3.0, True), (4.0, True)), ()).answer == "2"
