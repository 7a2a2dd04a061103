import math

import numpy as np
import pytest

from coral.reef.answers import CentroidChoice, WaypointChoice
from coral.reef.belief import Belief
from coral.reef.camera import CameraCfg
from coral.reef.chain import Component
from coral.reef.costfield import CostFieldCfg
from coral.reef.fleet import Neighbour
from coral.reef.geometry import Pose
from coral.reef.mapping import OccupancyMap
from coral.reef.planner import Goal, HighLevelPlanner, PlannerCfg
from coral.reef.verify import VerifyCfg

HERE = Pose(10.0, 10.0, 0.0)


def belief_with(centroids, pose=HERE, explored=None, size=20.0):
    belief = Belief(OccupancyMap((size, size), CameraCfg()))
    belief.pose = pose
    belief._trail = [(pose.x, pose.y)]
    belief.tracker.update([Component(x=x, y=y, area_px=200, length_m=1.0) for x, y in centroids])
    belief.map.explored[:] = True if explored is None else explored
    return belief


def planner_for(belief, **changes):
    return HighLevelPlanner(
        belief, CostFieldCfg(), lambda kind, context: (kind, "0"), lambda belief: (), PlannerCfg(**changes)
    )


def visit(belief, index):
    track = next(t for t in belief.tracks if t.index == index)
    belief.tracker.mark_visited(track.x, track.y, 0.1)


def test_centroid_mode_while_an_unvisited_cluster_lies_ahead():
    planner = planner_for(belief_with([(14.0, 10.0), (6.0, 10.0)]))
    question = planner.observe(())
    assert planner.mode == "centroid"
    assert question.answer_type is CentroidChoice
    assert {c["index"] for c in question.facts["centroids"]} == {0, 1}


def test_waypoint_mode_when_only_open_water_lies_ahead():
    explored = np.ones((400, 400), bool)
    explored[:, 260:] = False
    belief = belief_with([(8.0, 10.0)], explored=explored)
    visit(belief, 0)
    planner = planner_for(belief)
    question = planner.observe(())
    assert planner.mode == "waypoint"
    assert question.answer_type is WaypointChoice
    assert question.facts["frontiers"][0]["forward_m"] == pytest.approx(3.0, abs=0.3)


def test_a_dead_end_turns_back_to_the_cluster_behind():
    belief = belief_with([(6.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    assert planner.mode == "centroid"
    assert question.facts["dead_end"]
    assert planner.verify(question, CentroidChoice(selected_centroid_index=0)) is None


def test_nothing_left_finishes():
    belief = belief_with([(12.0, 10.0)])
    visit(belief, 0)
    planner = planner_for(belief)
    assert planner.observe(()) is None
    assert planner.finished


def test_without_centroid_selection_only_waypoints_are_asked_for():
    planner = planner_for(belief_with([(14.0, 10.0)]), centroid_selection=False)
    planner.observe(())
    assert planner.mode == "waypoint"


@pytest.mark.parametrize(("index", "code"), [(9, "no-such-centroid"), (None, "no-such-centroid"), (1, "visited")])
def test_wrong_indices_are_refused_with_a_reason(index, code):
    belief = belief_with([(14.0, 10.0), (10.0, 13.0)])
    visit(belief, 1)
    planner = planner_for(belief)
    refusal = planner.verify(planner.observe(()), CentroidChoice(selected_centroid_index=index))
    assert refusal is not None
    assert refusal.code == code
    assert refusal.details["index"] == index


def test_a_cluster_behind_is_refused_while_one_is_ahead():
    planner = planner_for(belief_with([(14.0, 10.0), (5.0, 10.0)]))
    refusal = planner.verify(planner.observe(()), CentroidChoice(selected_centroid_index=1))
    assert refusal is not None
    assert refusal.code == "behind-robot"


def test_the_check_is_made_where_the_robot_is_when_the_answer_comes():
    belief = belief_with([(14.0, 10.0), (17.0, 10.0)])
    planner = planner_for(belief)
    question = planner.observe(())
    belief.pose = Pose(15.5, 10.0, 0.0)
    refusal = planner.verify(question, CentroidChoice(selected_centroid_index=0))
    assert refusal is not None
    assert refusal.code == "behind-robot"


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
    assert belief.goal == pytest.approx((5.0, 10.0))


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
