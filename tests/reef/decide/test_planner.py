import math
from dataclasses import replace

import numpy as np
import pytest
from beds import belief_with, see

from coral.reef.decide.answers import CentroidChoice, WaypointChoice, WaypointStep
from coral.reef.decide.planner import HighLevelPlanner, PlannerCfg
from coral.reef.decide.route import Goal, RouteCfg
from coral.reef.decide.topology import TopologyCfg
from coral.reef.decide.verify import VerifyCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.vehicle.fleet import Neighbour
from coral.reef.world.geometry import Pose

ANGLES = VerifyCfg(by="angles")


def planner_for(belief, **changes):
    return HighLevelPlanner(
        belief, CostFieldCfg(), lambda kind, context: (kind, "0"), lambda belief: (), PlannerCfg(**changes)
    )


def under_way(belief, *goals, **changes):
    """A planner whose robot drives to goals."""
    planner = planner_for(belief, route=RouteCfg(margin_s=0.0), **changes)
    planner.route.follow(goals, 0.0)
    return planner


def dot(index):
    return CentroidChoice(selected_centroid_index=index)


def test_centroid_mode_while_a_cluster_comes_first_in_the_tour():
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    question = planner.observe(())
    assert planner.mode == "centroid"
    assert question.answer_type is CentroidChoice
    assert {c["index"] for c in question.facts["centroids"]} == {0, 1}


def test_waypoint_mode_when_only_open_water_lies_ahead():
    explored = np.ones((400, 400), bool)
    explored[:, 260:] = False
    belief = belief_with([(8.0, 10.0)], explored=explored)
    see(belief, 0)
    planner = planner_for(belief)
    question = planner.observe(())
    assert planner.mode == "waypoint"
    assert question.answer_type is WaypointChoice
    assert question.facts["frontiers"][0]["forward_m"] == pytest.approx(3.0, abs=0.3)


def test_by_angles_a_dead_end_turns_back_to_the_cluster_behind():
    planner = planner_for(belief_with([(6.0, 10.0)]), verify=ANGLES)
    question = planner.observe(())
    assert planner.mode == "centroid"
    assert planner.verify(question, dot(0)) is None


def test_nothing_left_finishes():
    belief = belief_with([(12.0, 10.0)])
    see(belief, 0)
    planner = planner_for(belief)
    assert planner.observe(()) is None
    assert planner.finished


def test_a_robot_that_does_not_explore_is_done_when_no_cluster_is_left():
    explored = np.ones((400, 400), bool)
    explored[:, 300:] = False
    belief = belief_with([(12.0, 10.0)], explored=explored)
    planner = planner_for(belief, explore=False)
    question = planner.observe(())
    assert question.kind == "reef-centroid"
    assert question.facts["frontiers"] == []
    see(belief, 0)
    assert planner.observe(()) is None
    assert planner.finished


def test_a_doubtful_cluster_is_looked_at_last():
    belief = belief_with([(12.0, 10.0), (14.0, 13.0)])
    belief.tracker.tracks[0] = replace(belief.tracks[0], doubtful=True)
    planner = planner_for(belief)
    facts = planner.observe(()).facts["centroids"]
    assert [c.get("doubtful", False) for c in sorted(facts, key=lambda c: c["index"])] == [True, False]
    see(belief, 1)
    question = planner.observe(())  # nothing else is left: now it is a dot like others
    assert not any(c.get("doubtful") for c in question.facts["centroids"])
    assert planner.acceptable == 1
    assert not planner.finished


def test_the_last_look_of_a_snapshot_is_taken_over():
    belief = belief_with([(12.0, 10.0)])
    belief.tracker.tracks[0] = replace(belief.tracks[0], doubtful=True)
    planner = planner_for(belief)
    prepared = planner.on(belief.snapshot())
    assert prepared.observe(()) is not None
    assert belief.unvisited() == []
    planner.take(prepared)
    assert [track.index for track in belief.unvisited()] == [0]


def test_without_centroid_selection_only_waypoints_are_asked_for():
    planner = planner_for(belief_with([(14.0, 10.0)]), centroid_selection=False)
    planner.observe(())
    assert planner.mode == "waypoint"


@pytest.mark.parametrize(("index", "code"), [(9, "no-such-centroid"), (None, "no-such-centroid"), (1, "visited")])
def test_wrong_indices_are_refused_with_a_reason(index, code):
    belief = belief_with([(14.0, 10.0), (10.0, 13.0)])
    see(belief, 1)
    planner = planner_for(belief)
    refusal = planner.verify(planner.observe(()), CentroidChoice(selected_centroid_index=index))
    assert refusal is not None
    assert refusal.code == code
    assert refusal.details["index"] == index


def test_by_angles_a_cluster_behind_is_refused_while_one_is_ahead():
    planner = planner_for(belief_with([(14.0, 10.0), (5.0, 10.0)]), verify=ANGLES)
    refusal = planner.verify(planner.observe(()), dot(1))
    assert refusal is not None
    assert refusal.code == "behind-robot"


def test_the_limits_of_the_fixed_angles_are_told_where_they_judge():
    told = planner_for(belief_with([(14.0, 10.0)]), verify=ANGLES).observe(()).facts
    assert (told["limits"]["back_deg"], told["limits"]["deviation_deg"]) == (120.0, 60.0)
    assert "limits" not in planner_for(belief_with([(14.0, 10.0)])).observe(()).facts


def test_a_choice_that_delays_the_rest_is_refused_and_a_better_one_named():
    planner = planner_for(belief_with([(12.0, 10.0), (13.0, 12.0), (2.0, 2.0)]))
    refusal = planner.verify(planner.observe(()), dot(2))
    assert refusal is not None
    assert refusal.code == "regret"
    assert refusal.details["better"] == 0
    assert refusal.details["regret_s"] > 10.0
    assert "These would pass: 0, 1" in refusal.reason


def test_the_same_choice_passes_where_nothing_is_regretted():
    beds = [(12.0, 10.0), (13.0, 12.0), (2.0, 2.0)]
    patient = planner_for(belief_with(beds), topology=TopologyCfg(max_regret_s=1e3))
    assert patient.verify(patient.observe(()), dot(2)) is None
    unchecked = planner_for(belief_with(beds), verify=VerifyCfg(enabled=False))
    assert unchecked.verify(unchecked.observe(()), dot(2)) is None


def test_what_the_robot_does_while_it_waits_refuses_no_answer():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    belief.pose = Pose(19.0, 10.0, 0.0)  # past both
    see(belief, 0)
    assert planner.verify(question, dot(0)) is None


def test_an_obstacle_that_was_found_meanwhile_does():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    belief.map.obstacle[:, 240:244] = True
    belief.map.version += 1
    assert planner.verify(question, dot(0)).code == "blocked"


def test_what_will_be_done_on_arrival_is_not_on_offer():
    belief = belief_with([(12.0, 10.0), (18.0, 10.0)])
    planner = under_way(belief, Goal(x=12.0, y=10.0, index=0))
    question = planner.observe(())
    shown = {c["index"]: c["visited"] for c in question.facts["centroids"]}
    assert shown == {0: True, 1: False}
    assert planner.verify(question, dot(0)).code == "visited"
    assert planner.verify(question, dot(1)) is None
    assert planner.onward(question, CentroidChoice(selected_centroid_index=1, then=(0,))) == []


def test_places_are_told_as_seen_on_arrival():
    belief = belief_with([(18.0, 10.0)])
    planner = under_way(belief, Goal(x=10.0, y=13.0))
    question = planner.observe(())
    arrival = question.facts["arrival"]
    assert arrival["in_s"] > 1.0
    assert arrival["pose"]["theta"] == pytest.approx(math.pi / 2, abs=0.1)
    (cluster,) = question.facts["centroids"]
    assert cluster["left_m"] == pytest.approx(-8.0, abs=0.2)


def test_nothing_is_asked_while_everything_will_be_done():
    belief = belief_with([(12.0, 10.0)])
    planner = under_way(belief, Goal(x=12.0, y=10.0, index=0))
    assert planner.observe(()) is None
    assert not planner.finished


def test_some_choice_on_offer_is_acceptable():
    planner = planner_for(belief_with([(14.0, 10.0), (5.0, 10.0), (3.0, 17.0)]))
    question = planner.observe(())
    passes = [c["index"] for c in question.facts["centroids"] if planner.verify(question, dot(c["index"])) is None]
    assert len(passes) == planner.acceptable >= 1


def test_goals_named_after_the_first_are_left_out_where_they_cannot_be_reached():
    belief = belief_with([(12.0, 10.0), (16.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    belief.map.obstacle[:, 280:284] = True
    belief.map.version += 1
    assert planner.onward(question, CentroidChoice(selected_centroid_index=0, then=(1,))) == []
    steps = (WaypointStep(forward_m=0, left_m=6), WaypointStep(forward_m=6, left_m=0))
    assert len(planner.onward(question, WaypointChoice(forward_m=1, left_m=0, then=steps))) == 1


def test_goals_named_after_the_first_follow_it():
    belief = belief_with([(12.0, 10.0), (14.0, 10.0), (16.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    see(belief, 1)
    onward = planner.onward(question, CentroidChoice(selected_centroid_index=0, then=(0, 1, 2)))
    assert [goal.index for goal in onward] == [2]
    steps = (WaypointStep(forward_m=2, left_m=-1), WaypointStep(forward_m=6, left_m=6))
    belief.pose = Pose(0.0, 0.0, 0.0)
    onward = planner.onward(question, WaypointChoice(forward_m=1, left_m=0, then=steps))
    assert [(goal.x, goal.y) for goal in onward] == [pytest.approx((12.0, 9.0)), pytest.approx((16.0, 16.0))]


def test_goals_named_after_the_first_end_where_one_delays_the_rest_too_much():
    belief = belief_with([(12.0, 10.0), (13.5, 10.0), (3.0, 10.0), (15.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())

    def named(*then):
        goals = planner.onward(question, CentroidChoice(selected_centroid_index=0, then=then))
        return [goal.index for goal in goals]

    assert named(1, 3, 2) == [1, 3, 2]
    assert named(1, 2, 3) == [1]
    planner.cfg = replace(planner.cfg, verify=replace(planner.cfg.verify, enabled=False))
    assert named(1, 2, 3) == [1, 2, 3]


def test_a_waypoint_means_the_frame_in_which_it_was_asked_for():
    explored = np.ones((400, 400), bool)
    explored[:, 300:] = False
    belief = belief_with([], explored=explored)
    planner = planner_for(belief)
    question = planner.observe(())
    belief.pose = Pose(12.0, 10.0, math.pi / 2)
    goal = planner.locate(question, WaypointChoice(forward_m=4, left_m=-1))
    assert isinstance(goal, Goal)
    assert (goal.x, goal.y) == pytest.approx((14.0, 9.0))


@pytest.mark.parametrize(("forward", "left", "code"), [(0, 0, "too-close"), (6, 6, "outside"), (4, 0, "blocked")])
def test_impossible_waypoints_are_refused(forward, left, code):
    explored = np.ones((400, 400), bool)
    explored[:, 340:] = False
    belief = belief_with([], pose=Pose(10.0, 15.0, 0.0), explored=explored)
    belief.map.obstacle[280:320, 270:290] = True
    belief.map.obstacle[280, 270:290] = True
    planner = planner_for(belief)
    refusal = planner.verify(planner.observe(()), WaypointChoice(forward_m=forward, left_m=left))
    assert refusal is not None
    assert refusal.code == code


def test_without_verification_geometry_is_not_checked_but_counted():
    belief = belief_with([(14.0, 10.0), (5.0, 10.0)])
    planner = planner_for(belief, verify=VerifyCfg(enabled=False))
    question = planner.observe(())
    answer = CentroidChoice(selected_centroid_index=1)
    assert planner.verify(question, answer) is None
    assert planner.adopt(planner.locate(question, answer)) is True


def test_a_target_that_another_robot_has_taken_is_refused_with_a_reason():
    belief = belief_with([(14.0, 10.0), (14.0, 12.5)])
    planner = planner_for(belief)
    index = {(t.x, t.y): t.index for t in belief.tracks}
    belief.others = (Neighbour(pose=Pose(12.0, 8.0, 0.0), radius_m=0.3, goal=(14.0, 10.0), index=index[14.0, 10.0]),)
    question = planner.observe(())
    shown = {c["index"]: c["taken"] for c in question.facts["centroids"]}
    assert shown == {index[14.0, 10.0]: True, index[14.0, 12.5]: False}
    assert question.facts["others"] == [{"forward_m": 2.0, "left_m": -2.0, "goal_forward_m": 4.0, "goal_left_m": 0.0}]
    refusal = planner.verify(question, CentroidChoice(selected_centroid_index=index[14.0, 10.0]))
    assert refusal.code == "taken"
    assert "Another robot" in refusal.reason
    assert planner.verify(question, CentroidChoice(selected_centroid_index=index[14.0, 12.5])) is None
