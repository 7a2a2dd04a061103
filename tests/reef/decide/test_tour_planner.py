import math
import re
from dataclasses import replace

import numpy as np
import pytest
from beds import belief_with, see
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.reef.decide.answers import CentroidChoice, Expectation, WaypointChoice, WaypointStep
from coral.reef.decide.planner import PlannerCfg
from coral.reef.decide.route import Goal, RouteCfg
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.world.geometry import Pose


def planner_for(belief, **changes):
    return TourPlanner(belief, CostFieldCfg(), lambda outlook: (), PlannerCfg(**changes))


def under_way(belief, *goals, **changes):
    """A planner whose robot drives to goals."""
    planner = planner_for(belief, route=RouteCfg(margin_s=0.0), **changes)
    planner.route.follow(goals, 0.0)
    return planner


def dot(index, **more):
    return CentroidChoice(selected_centroid_index=index, **more)


def step(forward, left, **more):
    return WaypointChoice(forward_m=forward, left_m=left, **more)


def half_known(x_m=15.0):
    """Explored water west of a line, as a map's mask."""
    explored = np.ones((400, 400), bool)
    explored[:, round(x_m / 0.05) :] = False
    return explored


def ask(planner, *rejections):
    return planner.ask(planner.outlook(), rejections)


def test_centroid_mode_while_a_cluster_comes_first_in_the_tour():
    asked = ask(planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)])))
    assert asked.mode == "centroid"
    assert asked.question.answer_type is CentroidChoice
    assert {c["index"] for c in asked.question.facts["centroids"]} == {0, 1}


def test_waypoint_mode_when_only_open_water_lies_ahead():
    belief = belief_with([(8.0, 10.0)], explored=half_known(13.0))
    see(belief, 0)
    asked = ask(planner_for(belief))
    assert asked.mode == "waypoint"
    assert asked.question.answer_type is WaypointChoice
    assert asked.question.facts["frontiers"][0]["forward_m"] == pytest.approx(3.0, abs=0.3)
    assert "first" not in asked.question.facts  # no dot is left: nothing to explain


def test_a_waypoint_question_while_dots_are_left_says_why_and_a_dot_may_be_named():
    belief = belief_with([(12.0, 10.0), (2.0, 2.0)], explored=half_known(12.5))
    see(belief, 0)
    planner = planner_for(belief)
    asked = ask(planner)
    assert asked.mode == "waypoint"
    assert asked.question.facts["first"]["dots"] == [1]
    assert planner.verify(asked, step(0, 0, dot=1)) is None
    assert planner.locate(asked, step(0, 0, dot=1)) == Goal(x=2.0, y=2.0, index=1)


def test_nothing_left_finishes():
    belief = belief_with([(12.0, 10.0)])
    see(belief, 0)
    asked = ask(planner_for(belief))
    assert asked.question is None
    assert asked.finished


def test_a_robot_that_does_not_explore_is_done_when_no_cluster_is_left():
    belief = belief_with([(12.0, 10.0)], explored=half_known())
    planner = planner_for(belief, explore=False)
    question = ask(planner).question
    assert question.kind == "reef-centroid"
    assert question.facts["frontiers"] == []
    see(belief, 0)
    assert ask(planner).finished


def test_a_doubtful_cluster_is_looked_at_last():
    belief = belief_with([(12.0, 10.0), (14.0, 13.0)])
    belief.tracker.tracks[0] = replace(belief.tracks[0], doubtful=True)
    planner = planner_for(belief)
    facts = ask(planner).question.facts["centroids"]
    assert [c.get("doubtful", False) for c in sorted(facts, key=lambda c: c["index"])] == [True, False]
    see(belief, 1)
    belief.tracker.tracks[0] = replace(belief.tracks[0], doubtful=True)
    asked = ask(planner)  # nothing else is left: now it is a dot like others
    assert not any(c.get("doubtful") for c in asked.question.facts["centroids"])
    assert asked.acceptable
    assert not asked.finished
    assert belief.unvisited() == []  # asking has changed nothing that the robot knows


def test_without_centroid_selection_only_waypoints_are_asked_for():
    assert ask(planner_for(belief_with([(14.0, 10.0)]), centroid_selection=False)).mode == "waypoint"


@pytest.mark.parametrize(("index", "code"), [(9, "no-such-centroid"), (None, "no-such-centroid"), (1, "visited")])
def test_wrong_indices_are_refused_with_a_reason(index, code):
    belief = belief_with([(14.0, 10.0), (10.0, 13.0)])
    see(belief, 1)
    planner = planner_for(belief)
    refusal = planner.verify(ask(planner), dot(index))
    assert refusal.code == code
    assert refusal.details["index"] == index


def test_to_differ_from_the_robot_s_own_tour_is_advised_against_and_not_refused():
    planner = planner_for(belief_with([(12.0, 10.0), (13.0, 12.0), (2.0, 2.0)]))
    asked = ask(planner)
    assert planner.verify(asked, dot(2)) is None
    told = planner.adopt(asked, dot(2), planner.locate(asked, dot(2)))
    assert told["later_s"] > 10.0
    advice = ask(planner).question.facts["advice"]
    assert advice == {"chosen": {"index": 2}, "later_s": round(told["later_s"]), "better": 0}
    planner.adopt(asked, dot(0), planner.locate(asked, dot(0)))
    assert "advice" not in ask(planner).question.facts


def test_green_without_a_dot_can_be_chosen_as_a_waypoint():
    planner = planner_for(belief_with([(14.0, 10.0)], explored=half_known()))
    asked = ask(planner)
    answer = dot(None, waypoint=WaypointStep(forward_m=3, left_m=3))
    assert asked.mode == "centroid"
    assert planner.verify(asked, answer) is None
    assert planner.locate(asked, answer) == Goal(x=13.0, y=13.0)


@pytest.mark.parametrize(("cells", "code"), [(8, None), (4, "finished")])
def test_green_without_a_dot_can_be_chosen_where_all_is_explored(cells, code):
    belief = belief_with([(16.0, 10.0)])
    belief.map.target[96 : 96 + cells, 96 : 96 + cells] = True
    planner = planner_for(belief)
    refusal = planner.verify(ask(planner), dot(None, waypoint=WaypointStep(forward_m=-5, left_m=-5)))
    assert (refusal and refusal.code) == code


def test_a_lone_dot_far_behind_is_not_the_only_answer():
    belief = belief_with([(2.0, 10.0)])
    see(belief, 0, share=0.92)
    planner = planner_for(belief)
    asked = ask(planner)
    assert planner.verify(asked, dot(None, end_survey=True)) is None
    see(belief, 0, share=0.4)
    planner = planner_for(belief_with([(2.0, 10.0)]))
    refusal = planner.verify(ask(planner), dot(None, end_survey=True))
    assert refusal.code == "not-done"


def test_the_survey_does_not_end_where_oysters_border_on_unknown_water():
    belief = belief_with([(14.0, 10.0)], explored=half_known(14.9))
    see(belief, 0)
    planner = planner_for(belief)
    assert planner.verify(ask(planner), step(0, 0, end_survey=True)).code == "not-done"
    far = belief_with([(8.0, 10.0)], explored=half_known())
    see(far, 0)
    planner = planner_for(far)
    assert planner.verify(ask(planner), step(0, 0, end_survey=True)) is None


def test_the_rest_can_be_left_to_the_robots_own_tour_until_it_finds_something():
    belief = belief_with([(8.0, 10.0)], explored=half_known())
    see(belief, 0)
    planner = planner_for(belief)
    asked, answer = ask(planner), step(0, 0, explore_rest=True)
    assert planner.verify(asked, answer) is None
    first = planner.locate(asked, answer)
    assert (first.x, first.y) == (asked.tour.best.x, asked.tour.best.y)
    planner.adopt(asked, answer, first)
    later = ask(planner)
    assert later.question is None
    assert (later.alone.x, later.alone.y) == (later.tour.best.x, later.tour.best.y)
    assert planner.onward(asked, step(0, 0, explore_rest=True, then=[{"forward_m": 3, "left_m": 0}])) == []


def test_the_rest_is_not_left_to_the_robot_while_there_are_dots():
    planner = planner_for(belief_with([(2.0, 10.0)], explored=half_known()))
    asked = ask(planner)
    refusal = planner.verify(asked, step(3, 0, explore_rest=True))
    assert refusal.code == "not-done"
    assert "0" in refusal.reason
    planner.adopt(asked, dot(0), Goal(x=2.0, y=10.0, index=0))
    assert ask(planner).question is not None


def test_who_was_left_alone_asks_when_there_is_a_dot():
    belief = belief_with([(2.0, 10.0)], explored=half_known())
    planner = planner_for(belief)
    seen = replace(planner.outlook(), alone=True)
    assert planner.ask(seen).question is not None


@pytest.mark.parametrize(
    "answer",
    [
        dot(0, end_survey=True),
        dot(0, waypoint=WaypointStep(forward_m=3, left_m=0)),
        dot(0, expect=Expectation(what="a twin reef", forward_m=30.0, left_m=0.0, sure=0.9)),  # off the map
        dot(0, expect=Expectation(what="a twin reef", forward_m=-9.0, left_m=0.0, sure=0.9)),  # behind
    ],
)
def test_an_answer_that_contradicts_itself_is_refused(answer):
    planner = planner_for(belief_with([(14.0, 10.0)]))
    assert planner.verify(ask(planner), answer).code == "contradiction"


def test_a_step_towards_what_is_expected_far_away_contradicts_nothing():
    belief = belief_with([(3.0, 10.0)], Pose(5.0, 10.0, 0.0), half_known())
    see(belief, 0)
    planner = planner_for(belief)
    guess = Expectation(what="the line of clusters goes on", forward_m=14.0, left_m=0.0, sure=0.9)
    assert planner.verify(ask(planner), step(5, 0, expect=guess)) is None


def finished_west():
    """A robot in the middle: all is known and done but the water east of 15 m."""
    belief = belief_with([(8.0, 10.0)], explored=half_known())
    see(belief, 0)
    return belief


def test_a_way_back_through_finished_water_is_refused_unless_a_guess_is_worth_it():
    planner = planner_for(finished_west())
    asked = ask(planner)
    assert planner.verify(asked, step(-4, 0)).code == "finished"
    assert planner.verify(asked, step(2, 2)) is None
    guess = Expectation(what="hidden by the last rock", sure=1.0)
    assert planner.verify(asked, step(-4, 0, expect=guess)) is None
    unsure = planner.verify(asked, step(-4, 0, expect=guess.model_copy(update={"sure": 0.05})))
    assert unsure.code == "too-dear"
    assert "inf" not in unsure.reason


def test_guesses_that_prove_wrong_may_cost_less():
    planner = planner_for(finished_west())
    guess = Expectation(what="there must be more", sure=0.9)
    asked = ask(planner)
    assert planner.verify(asked, step(-5, 0, expect=guess)) is None
    told = planner.adopt(asked, step(-5, 0, expect=guess), Goal(x=5.0, y=10.0))
    assert (told["expect"]["x"], told["expect"]["sure"]) == (5.0, 0.9)
    (out,) = planner.settle()  # the water there is known, and bare
    assert out.hit is False
    assert planner.settle() == []
    asked = ask(planner)
    assert asked.question.facts["guesses"] == {"right": 0, "wrong": 1, "open": 0, "allowance_s": 20.0}
    assert planner.verify(asked, step(-5, 0, expect=guess)).code == "too-dear"


def test_without_verification_only_points_off_the_map_are_refused():
    planner = planner_for(finished_west(), checks=False)
    asked = ask(planner)
    assert planner.verify(asked, step(-4, 0)) is None
    planner.belief.pose = Pose(10.0, 18.0, 0.0)
    assert planner.verify(ask(planner), step(0, 6)).code == "outside"


def test_what_the_robot_does_while_it_waits_refuses_no_answer():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    belief.pose = Pose(19.0, 10.0, 0.0)  # past both
    see(belief, 0)
    assert planner.verify(asked, dot(0)) is None


def test_an_obstacle_that_was_found_meanwhile_does():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    belief.map.obstacle[:, 240:244] = True
    belief.map.version += 1
    assert planner.verify(asked, dot(0)).code == "blocked"


def test_a_choice_means_the_cluster_that_had_the_label_when_it_was_asked_for():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    belief.tracker.tracks = [replace(belief.tracks[0], index=7, x=14.5), belief.tracks[1]]  # the map grew: a new label
    assert planner.verify(asked, dot(0)) is None
    assert planner.locate(asked, dot(0)) == Goal(x=14.5, y=10.0, index=7)
    belief.tracker.tracks = belief.tracks[1:]  # it was none
    assert planner.verify(asked, dot(0)) is None
    assert planner.locate(asked, dot(0)) is None


def test_only_what_is_done_whatever_is_answered_is_not_on_offer():
    # The present goal will be done before an answer, and what lies on the way to it. What lies beyond is open.
    belief = belief_with([(11.5, 10.0), (12.5, 10.0), (14.5, 10.0), (18.0, 10.0)])
    planner = under_way(belief, Goal(x=12.5, y=10.0, index=1))
    asked = ask(planner)
    assert asked.outlook.arrival.pose.x > 11.0
    shown = {c["index"]: c["visited"] for c in asked.question.facts["centroids"]}
    assert shown == {0: True, 1: True, 2: False, 3: False}
    assert planner.verify(asked, dot(1)).code == "visited"
    assert planner.verify(asked, dot(2)) is None
    assert planner.onward(asked, dot(2, then=(0,))) == []


def test_what_is_passed_only_if_the_plan_goes_on_stays_on_offer():
    belief = belief_with([(12.0, 10.0), (18.0, 10.0)])
    planner = under_way(belief, Goal(x=18.0, y=10.0, index=1))
    asked = ask(planner)
    assert asked.outlook.arrival.pose.x > 12.5  # past the first dot, if the robot goes on
    assert not any(c["visited"] for c in asked.question.facts["centroids"])


def test_places_are_told_as_seen_on_arrival():
    belief = belief_with([(18.0, 10.0)])
    planner = under_way(belief, Goal(x=10.0, y=13.0))
    facts = ask(planner).question.facts
    assert facts["arrival"]["in_s"] > 1.0
    assert facts["arrival"]["pose"]["theta"] == pytest.approx(math.pi / 2, abs=0.1)
    (cluster,) = facts["centroids"]
    assert cluster["left_m"] == pytest.approx(-8.0, abs=0.2)


def test_nothing_is_asked_while_everything_will_be_done():
    belief = belief_with([(12.0, 10.0)])
    asked = ask(under_way(belief, Goal(x=12.0, y=10.0, index=0)))
    assert asked.question is None
    assert not asked.finished


PLACES = st.lists(st.tuples(st.integers(2, 18), st.integers(2, 18)), min_size=1, max_size=6, unique=True)


@settings(max_examples=25, deadline=None)
@given(PLACES, st.integers(8, 20), st.floats(-3.1, 3.1), st.integers(0, 63), st.booleans())
def test_a_place_that_a_question_names_is_accepted(places, known_m, theta, seen, wall):
    belief = belief_with([(float(x), float(y)) for x, y in places], Pose(7.0, 10.0, theta), half_known(known_m))
    if wall:
        belief.map.obstacle[100:300, 190:194] = True
    for track in belief.tracks:
        if seen >> track.index & 1:
            see(belief, track.index)
    planner = planner_for(belief)
    first = ask(planner)
    if first.question is None:
        return
    refusal = planner.verify(first, dot(99)) or planner.verify(first, step(0, 0))
    asked = ask(planner, refusal)
    named = asked.question.facts["passing"]
    assert named["dots"] or named["waypoints"]
    for label in named["dots"]:
        assert planner.verify(asked, dot(label)) is None
        assert planner.verify(asked, step(0, 0, dot=label)) is None
    for forward, left in named["waypoints"]:
        assert planner.verify(asked, step(forward, left)) is None
        assert planner.verify(asked, dot(None, waypoint=WaypointStep(forward_m=forward, left_m=left))) is None
    told = re.search(r"left: ([\d, ]+)", refusal.reason)
    for label in told[1].split(", ") if told else ():
        assert planner.verify(asked, dot(int(label))) is None


def test_goals_named_after_the_first_are_left_out_where_they_cannot_be_reached():
    belief = belief_with([(12.0, 10.0), (16.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    belief.map.obstacle[:, 280:284] = True
    belief.map.version += 1
    assert planner.onward(asked, dot(0, then=(1,))) == []
    steps = (WaypointStep(forward_m=0, left_m=6), WaypointStep(forward_m=6, left_m=0))
    assert len(planner.onward(asked, step(1, 0, then=steps))) == 1


def test_goals_named_after_the_first_follow_it():
    belief = belief_with([(12.0, 10.0), (14.0, 10.0), (16.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    see(belief, 1)
    assert [goal.index for goal in planner.onward(asked, dot(0, then=(0, 1, 2)))] == [2]
    steps = (WaypointStep(forward_m=2, left_m=-1), WaypointStep(forward_m=6, left_m=6))
    belief.pose = Pose(0.0, 0.0, 0.0)
    onward = planner.onward(asked, step(1, 0, then=steps))
    assert [(goal.x, goal.y) for goal in onward] == [pytest.approx((12.0, 9.0)), pytest.approx((16.0, 16.0))]


@pytest.mark.parametrize(("forward", "left", "code"), [(0, 0, "too-close"), (6, 6, "outside"), (4, 0, "blocked")])
def test_impossible_waypoints_are_refused(forward, left, code):
    belief = belief_with([], pose=Pose(10.0, 15.0, 0.0), explored=half_known(17.0))
    belief.map.obstacle[280:320, 270:290] = True
    planner = planner_for(belief)
    assert planner.verify(ask(planner), step(forward, left)).code == code


def test_violations_of_the_paper_s_angles_are_counted():
    belief = belief_with([(14.0, 10.0), (5.0, 10.0)])
    planner = planner_for(belief)
    asked = ask(planner)
    assert planner.adopt(asked, dot(1), planner.locate(asked, dot(1)))["violates"] is True
    assert planner.adopt(asked, dot(0), planner.locate(asked, dot(0)))["violates"] is False
