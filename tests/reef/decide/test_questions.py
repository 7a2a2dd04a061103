from dataclasses import replace

from beds import belief_with

from coral.advisor.question import Rejection
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.planner import AskedState
from coral.reef.decide.questions import goal_of_dot, goal_of_step, outside, surroundings
from coral.reef.decide.route import Goal
from coral.reef.decide.survey import SurveyCfg, survey
from coral.reef.map.costfield import CostFieldCfg


def asked_of(belief):
    outlook = Outlook.now(belief.snapshot())
    left = survey(outlook, CostFieldCfg(), 1.0, SurveyCfg())
    return AskedState(
        question=None, mode="centroid", outlook=outlook, left=left, around=surroundings(outlook, left, 1.0)
    )


def test_a_label_means_the_cluster_of_the_question():
    belief = belief_with([(14.0, 10.0), (8.0, 10.0)])
    asked = asked_of(belief)
    assert goal_of_dot(asked, 0, belief) == Goal(x=14.0, y=10.0, index=0)
    refusal = goal_of_dot(asked, 5, belief)
    assert isinstance(refusal, Rejection)
    assert "0, 1" in refusal.reason


def test_what_was_seen_from_afar_is_found_farther_off_under_its_new_label():
    belief = belief_with([(14.0, 10.0)])
    belief.tracker.tracks = [replace(belief.tracks[0], far=True)]
    asked = asked_of(belief)
    belief.tracker.tracks = [replace(belief.tracks[0], index=3, x=16.0, far=False)]
    assert goal_of_dot(asked, 0, belief).index == 3
    belief.tracker.tracks = [replace(belief.tracks[0], x=17.0)]
    assert goal_of_dot(asked, 0, belief) is None


def test_a_step_is_measured_from_the_arrival_and_ends_where_the_map_does():
    belief = belief_with([])
    goal = goal_of_step(asked_of(belief), 2, 3)
    assert (goal.x, goal.y) == (12.0, 13.0)
    assert outside(goal, belief) is None
    assert outside(Goal(x=21.0, y=3.0), belief).code == "outside"
