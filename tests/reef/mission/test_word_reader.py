"""The perfect reader of missions in words."""

from __future__ import annotations

import math

import pytest

from coral.advisor.question import Rejection
from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError
from coral.reef.mission.assembly import decider_of
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.variants import apply_variant
from coral.reef.mission.word_reader import READ_M, WordReader
from coral.reef.world.world import ReefWorld, load_world

THINGS = {"tyre": ("tyre", 12.0, 10.0), "bed": ("mussels", 7.0, 10.0), "ball": ("reef-ball", 12.0, 4.0)}
TYRE = ({"kind": "inspected", "of": ["tyre"], "count": 1},)
STEPS = [
    {"forward_m": f, "left_m": s, "path_m": math.hypot(f, s), "unexplored": 0.1}
    for f in range(-6, 7)
    for s in range(-6, 7)
    if math.hypot(f, s) >= 1.0
]


def reader(*conditions, visibility_m=None):
    return WordReader(
        ReefWorld.model_validate(
            {
                "name": "yard",
                "size_m": [26.0, 20.0],
                "start": {"x": 2.0, "y": 10.0},
                "things": [{"name": n, "kind": kind, "x": x, "y": y} for n, (kind, x, y) in THINGS.items()],
                "mission": {"instruction": "Do it.", "time_s": 300.0, "conditions": list(conditions)},
            }
        ),
        visibility_m,
    )


def facts(names=(), *, seen=(), visited=(), at=(2.0, 10.0), at_s=10.0, frontiers=()):
    """Return what a question tells; the robot heads east."""
    dots = [(THINGS[n][1] - at[0], THINGS[n][2] - at[1]) for n in names]
    pose = {"x": at[0], "y": at[1], "theta": 0.0}
    return {
        "robot": {**pose, "x": -90.0},  # nothing near enough in the picture of this moment
        "arrival": {"pose": pose, "in_s": 0.0},
        "mission": {
            "at_s": at_s,
            "time_s": 300.0,
            "home": {"forward_m": 2.0 - at[0], "left_m": 10.0 - at[1]},
            "pictures": [{"dot": names.index(n), "distance_m": m, "age_s": 3} for n, m in dict(seen).items()],
        },
        "centroids": [
            {"index": k, "forward_m": f, "left_m": s, "path_m": math.hypot(f, s), "visited": names[k] in visited}
            for k, (f, s) in enumerate(dots)
        ],
        "frontiers": list(frontiers),
        "options": STEPS,
    }


def test_what_it_has_not_seen_from_near_it_looks_at_from_beyond_what_counts_as_a_visit():
    answer = reader(*TYRE)(facts(("tyre",), seen={"tyre": READ_M + 0.1}), ())
    assert answer.look.dot == 0
    assert answer.look.distance_m > 2.5


def test_a_look_that_told_nothing_is_repeated_from_nearer():
    murky, question = reader(*TYRE, visibility_m=4.5), facts(("tyre",), seen={"tyre": 3.0})
    first, again = (murky(question, ()).look.distance_m for _ in range(2))
    assert first > again >= 2.2


def test_in_murky_water_it_must_come_nearer_to_tell():
    murky = reader(*TYRE, visibility_m=4.5)(facts(("tyre",), seen={"tyre": 2.8}), ())
    assert murky.look.distance_m <= 2.4


def test_what_it_has_seen_it_goes_to_if_that_is_wanted_and_leaves_alone_if_not():
    assert reader(*TYRE)(facts(("tyre",), seen={"tyre": READ_M}), ()).selected_centroid_index == 0
    assert reader(*TYRE)(facts(("bed",), seen={"bed": 4.0}), ()).done  # nothing else to find


def test_it_ends_with_the_answer_when_it_has_done_what_was_asked():
    counted = reader({"kind": "inspected", "of": ["reef-ball"]}, {"kind": "answered", "right": ["1"]})
    answer = counted(facts(("ball",), seen={"ball": 3.0}, visited=("ball",)), ())
    assert (answer.done, answer.answer) == (True, "1")


def test_it_keeps_an_order():
    ordered = reader({"kind": "in_order", "of": ["reef-ball", "tyre"]})
    answer = ordered(facts(("tyre", "ball"), seen={"tyre": 3.0, "ball": 3.0}, at=(9.0, 6.0)), ())
    assert answer.selected_centroid_index == 1


def test_it_sees_sides_and_takes_another_where_there_is_no_way():
    sides = reader({"kind": "sides", "of": ["tyre"], "count": 2})
    question = facts(("tyre",), seen={"tyre": 3.0})
    assert sides(question, ()).look.side == "near"
    assert sides(question, ()).look.side == "right"
    refused = [Rejection(code="blocked", reason="no way")]
    sides = reader({"kind": "sides", "of": ["tyre"], "count": 3})
    assert [sides(question, ()).look.side for _ in range(2)] == ["near", "right"]
    assert sides(question, ()).look.side == "right"
    assert sides(question, refused).look.side == "left"


def test_it_does_not_turn_back_to_a_side_that_it_has_seen():
    sides = reader({"kind": "sides", "of": ["tyre"], "count": 3})
    blocked = [Rejection(code="blocked", reason="no way")]
    west, north, east = (
        facts(("tyre",), seen={"tyre": 3.0}, at=at) for at in ((8.0, 10.0), (12.0, 14.0), (16.0, 10.0))
    )
    assert sides(west, ()).look.side == "near"
    assert [sides(west, refused).look.side for refused in ((), blocked)] == ["right", "left"]
    assert sides(north, ()).look.side == "left"  # to its right is the west
    assert sides(east, ()).done


def test_where_there_is_no_way_to_a_side_it_goes_round_by_a_waypoint_and_looks_from_there():
    sides = reader({"kind": "sides", "of": ["tyre"], "count": 2})
    west = facts(("tyre",), seen={"tyre": 3.0}, at=(8.0, 10.0))
    assert [sides(west, ()).look.side for _ in range(2)] == ["near", "right"]
    step = sides(west, [Rejection(code="blocked", reason="no way")] * 2).waypoint
    assert math.dist((8.0 + step.forward_m, 10.0 + step.left_m), (12.0, 10.0)) > 2.6
    assert abs(step.left_m) >= 2
    assert sides(facts(("tyre",), seen={"tyre": 3.0}, at=(10.0, 13.5)), ()).look.side == "near"


def test_it_ends_where_it_is_told_to_even_if_it_has_been_there():
    along = reader({"kind": "inspected", "of": ["tyre"]}, {"kind": "ends_at", "at": "ball"})
    both, seen = ("tyre", "ball"), {"tyre": 3.0, "ball": 3.0}
    assert along(facts(both, seen=seen, visited=("ball",), at=(12.0, 5.0)), ()).selected_centroid_index == 0
    back = along(facts(both, seen=seen, visited=both, at=(12.0, 9.0)), ())
    assert back.waypoint.left_m < 0  # its dot is done: by a waypoint, to the south
    assert along(facts(both, seen=seen, visited=both, at=(12.0, 5.0)), ()).done


def test_it_needs_a_mission_in_words():
    cfg = apply_variant("reader", MissionCfg())
    with pytest.raises(InputError, match="a mission in words"):
        decider_of(cfg, RuleAdvisor({}), 0, load_world("s1"))


def test_it_is_home_in_time():
    home = reader(*TYRE, {"kind": "ends_at"})
    assert home(facts(at=(10.0, 10.0), at_s=275.0), ()).home
