"""Algorithm 2 as the paper has it."""

import math

import numpy as np
import pytest
from beds import belief_with

from coral.reef.decide.answers import CentroidAnswer, WaypointAnswer
from coral.reef.decide.paper_planner import PaperPlanner
from coral.reef.decide.planner import PlannerCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.world.geometry import Pose


def planner_for(belief, **changes):
    return PaperPlanner(belief, CostFieldCfg(), lambda outlook: (), PlannerCfg(algorithm="paper", **changes))


def ask(planner, *rejections):
    return planner.ask(planner.outlook(), rejections)


def dot(index):
    return CentroidAnswer(selected_centroid_index=index)


def half_known():
    explored = np.ones((400, 400), bool)
    explored[:, 300:] = False
    return explored


def test_a_dot_is_asked_for_while_one_lies_ahead_and_a_waypoint_else():
    ahead = ask(planner_for(belief_with([(14.0, 10.0)], inspect=False)))
    assert (ahead.mode, ahead.question.answer_type) == ("centroid", CentroidAnswer)
    behind = ask(planner_for(belief_with([(6.0, 10.0)], inspect=False)))
    assert (behind.mode, behind.question.answer_type) == ("waypoint", WaypointAnswer)
    assert [q.kind for q in (ahead.question, behind.question)] == ["reef-centroid", "reef-waypoint"]


def test_the_prompts_have_the_paper_s_points_and_tell_no_thresholds():
    prompt = ask(planner_for(belief_with([(14.0, 10.0)], inspect=False))).question.prompt
    assert all(f"{n}. **" in prompt for n in range(1, 6))
    assert all(f"   - {rule}." in prompt for rule in "abcd")
    assert "120" not in prompt
    assert "limits" not in ask(planner_for(belief_with([(14.0, 10.0)], inspect=False))).question.facts


def test_a_refusal_names_the_failure_mode_and_nothing_else():
    planner = planner_for(belief_with([(14.0, 10.0), (5.0, 10.0)], inspect=False))
    refusal = planner.verify(ask(planner), dot(1))
    assert refusal.code == "behind-robot"
    assert refusal.reason == "The chosen point is behind the robot."
    assert planner.verify(ask(planner), dot(9)).code == "no-such-centroid"


def test_the_backward_check_holds_when_the_answer_comes_too():
    belief = belief_with([(12.0, 10.0), (16.0, 10.0)], inspect=False)
    planner = planner_for(belief)
    asked = ask(planner)
    assert planner.verify(asked, dot(0)) is None
    belief.pose = Pose(14.5, 10.0, 0.0)  # it has driven past the first dot meanwhile
    assert planner.verify(asked, dot(0)).code == "behind-robot"
    assert planner.verify(asked, dot(1)) is None


def test_a_new_goal_lies_apart_from_the_previous_one():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)], inspect=False)
    belief.goal = (13.6, 10.0)
    planner = planner_for(belief)
    assert planner.verify(ask(planner), dot(0)).code == "too-close"
    assert planner.verify(ask(planner), dot(1)) is None


def test_without_verification_everything_on_the_map_passes_and_violations_are_counted():
    planner = planner_for(belief_with([(14.0, 10.0), (5.0, 10.0)], inspect=False), checks=False)
    asked = ask(planner)
    assert planner.verify(asked, dot(1)) is None
    assert planner.adopt(asked, dot(1), planner.locate(asked, dot(1))) == {"violates": True}
    planner.belief.pose = Pose(18.0, 10.0, 0.0)
    assert planner.verify(ask(planner), WaypointAnswer(forward_m=6, left_m=0)).code == "outside"


def test_a_waypoint_is_measured_from_the_robot_and_stands_alone():
    belief = belief_with([], explored=half_known(), inspect=False)
    planner = planner_for(belief)
    asked = ask(planner)
    assert asked.outlook.arrival.pose == belief.pose
    goal = planner.locate(asked, WaypointAnswer(forward_m=4, left_m=-1))
    assert (goal.x, goal.y) == pytest.approx((14.0, 9.0))
    assert planner.onward(asked, WaypointAnswer(forward_m=4, left_m=-1)) == []
    assert planner.settle() == []


def test_the_mission_is_complete_when_nothing_is_left():
    assert ask(planner_for(belief_with([], inspect=False))).finished
    walled = belief_with([(14.0, 10.0)], inspect=False)
    walled.map.obstacle[:, 240:244] = True
    assert ask(planner_for(walled)).finished
    assert math.isinf(ask(planner_for(walled)).left.path_m(14.0, 10.0))
