"""Questions of missions in words: nothing is refused but what is unsafe, out of reach or contradicts itself."""

from __future__ import annotations

import math

import pytest
from beds import belief_with, see

from coral.reef.decide.answers import LookFrom, Mark, MissionAnswer
from coral.reef.decide.mission_planner import MissionPlanner, way_round
from coral.reef.decide.planner import InstructionCfg, PlannerCfg
from coral.reef.decide.route import Goal
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.mission.assembly import make_planner

TOLD = InstructionCfg(text="Find the ghost net.", time_s=180.0)


def planner_for(belief):
    planner = make_planner(belief, CostFieldCfg(), lambda outlook: (), PlannerCfg(instruction=TOLD))
    assert isinstance(planner, MissionPlanner)
    return planner


def test_the_prompt_tells_the_instruction_and_what_was_said_of_things():
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    asked = planner.ask(planner.outlook())
    assert "Find the ghost net." in asked.question.prompt
    answer = MissionAnswer(selected_centroid_index=0, marks=(Mark(dot=1, label="tyre"),), skip=(1,))
    assert planner.verify(asked, answer) is None
    planner.adopt(asked, answer, planner.locate(asked, answer))
    later = planner.ask(planner.outlook())
    assert "Dot 1: tyre." in later.question.prompt
    assert "Ruled out: dots 1." in later.question.prompt
    assert [dot["visited"] for dot in later.question.facts["centroids"]] == [False, True]


def test_what_was_ruled_out_is_told_and_kept_clear_of_after_its_dot_has_vanished():
    belief = belief_with([(14.0, 10.0), (6.0, 10.0)])
    planner = planner_for(belief)
    asked = planner.ask(planner.outlook())
    answer = MissionAnswer(selected_centroid_index=0, marks=(Mark(dot=1, label="tyre"),), skip=(1,))
    planner.adopt(asked, answer, planner.locate(asked, answer))
    belief.tracker.tracks = [track for track in belief.tracks if track.index != 1]
    x, y = belief.pose[:2]
    assert f"No dot any more, {6.0 - x} m forward and {10.0 - y} m to the left: tyre, ruled out." in (
        planner.ask(planner.outlook()).question.prompt
    )
    planner.route.follow([Goal(x=14.0, y=10.0, index=0)], 0.0)
    planner.route.update(0.1)
    assert list(belief.unchosen) == [(6.0, 10.0)]


def test_what_was_ruled_out_is_open_again_once_it_is_chosen():
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    asked = planner.ask(planner.outlook())
    out = MissionAnswer(selected_centroid_index=0, skip=(1,))
    planner.adopt(asked, out, planner.locate(asked, out))
    asked = planner.ask(planner.outlook())
    back = MissionAnswer(selected_centroid_index=1)
    assert planner.verify(asked, back) is None
    planner.adopt(asked, back, planner.locate(asked, back))
    assert "Ruled out" not in planner.ask(planner.outlook()).question.prompt


def test_a_look_at_what_the_map_no_longer_shows_goes_where_it_stood():
    belief = belief_with([(14.0, 10.0), (6.0, 10.0)])
    planner = planner_for(belief)
    asked = planner.ask(planner.outlook())
    belief.tracker.tracks = [track for track in belief.tracks if track.index != 0]
    look = MissionAnswer(look=LookFrom(dot=0, distance_m=2.0))
    assert planner.verify(asked, look) is None
    assert planner.locate(asked, look).face == pytest.approx((14.0, 10.0))


def test_a_question_is_asked_even_when_nothing_is_left():
    belief = belief_with([(12.0, 10.0)])
    see(belief, 0)
    planner = planner_for(belief)
    asked = planner.ask(planner.outlook())
    assert not asked.finished
    assert planner.verify(asked, MissionAnswer(done=True, answer="none")) is None


@pytest.mark.parametrize(
    ("answer", "code"),
    [
        (MissionAnswer(), "contradiction"),
        (MissionAnswer(selected_centroid_index=0, home=True), "contradiction"),
        (MissionAnswer(selected_centroid_index=7), "no-such-centroid"),
        (MissionAnswer(waypoint={"forward_m": 0, "left_m": 0}), "too-close"),
        (MissionAnswer(selected_centroid_index=1), None),  # behind, and the farther one
        (MissionAnswer(waypoint={"forward_m": -3, "left_m": 0}), None),  # back through known water
        (MissionAnswer(home=True), None),
        (MissionAnswer(look=LookFrom(dot=0, side="far")), None),
        (MissionAnswer(done=True), None),  # early, and without an answer
    ],
)
def test_what_is_refused(answer, code):
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    refusal = planner.verify(planner.ask(planner.outlook()), answer)
    assert (refusal and refusal.code) == code


def test_a_look_from_behind_goes_round_at_a_distance_and_ends_towards_the_thing():
    goals = way_round(LookFrom(dot=0, side="far", distance_m=2.0), (10.0, 10.0), (4.0, 10.0))
    assert all(math.dist((g.x, g.y), (10.0, 10.0)) > 3.9 for g in goals[:-1])
    assert math.dist((goals[-1].x, goals[-1].y), (12.0, 10.0)) < 1e-6
    assert goals[-1].face == (10.0, 10.0)


def test_whoever_is_nearer_than_a_look_stays_and_turns_to_the_thing():
    goal = way_round(LookFrom(dot=0, distance_m=2.5), (10.0, 10.0), (8.0, 10.0))[0]
    assert (goal.x, goal.y) == pytest.approx((8.0, 10.0))
    assert goal.face == (10.0, 10.0)


def test_a_look_at_the_left_goes_to_the_left_as_the_robot_sees_it():
    goals = way_round(LookFrom(dot=0, side="left"), (10.0, 10.0), (4.0, 10.0))
    assert goals[-1].y > 10.5


def test_a_look_is_refused_from_where_there_is_no_room_to_turn_to_the_thing():
    planner = planner_for(belief_with([(4.0, 10.0)]))
    asked = planner.ask(planner.outlook())
    far = MissionAnswer(look=LookFrom(dot=0, side="far", distance_m=3.0))
    assert planner.verify(asked, far).code == "blocked"  # 1 m from the edge, and the way there begins outside
    near = MissionAnswer(look=LookFrom(dot=0, side="far", distance_m=1.5))
    assert planner.verify(asked, near) is None


def test_home_is_where_it_set_out():
    belief = belief_with([(14.0, 10.0)])
    planner = planner_for(belief)
    asked = planner.ask(planner.outlook())
    x, y = belief.trajectory[0]
    assert planner.locate(asked, MissionAnswer(home=True)) == Goal(x=x, y=y)


def test_other_words_are_told_next_and_what_was_ruled_out_is_open_again():
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    asked = planner.ask(planner.outlook())
    answer = MissionAnswer(selected_centroid_index=0, marks=(Mark(dot=1, label="tyre"),), skip=(1,), reason="a ring")
    told = planner.adopt(asked, answer, planner.locate(asked, answer))
    assert [(s["dot"], s["label"], s["skip"], s["why"]) for s in told["said"]] == [(1, "tyre", True, "a ring")]
    planner.instruct("Inspect the tyre.")
    later = planner.ask(planner.outlook())
    assert "Inspect the tyre." in later.question.prompt
    assert "Dot 1: tyre." in later.question.prompt
    assert "Ruled out" not in later.question.prompt
    assert not later.question.facts["centroids"][1]["visited"]
