import math

import numpy as np
import pytest
from beds import belief_with, see

from coral.reef.decide.route import Goal, Route, RouteCfg, aim, moved_clear, passed
from coral.reef.map.costfield import CostField
from coral.reef.world.geometry import Pose

HERE = Pose(10.0, 10.0, 0.0)
CFG = RouteCfg(cruise_m_s=0.5, margin_s=0.0, short_m=0.2)


def dot(belief, index):
    track = belief.track(index)
    return Goal(x=track.x, y=track.y, index=index)


def test_a_cluster_is_done_when_it_has_been_seen_and_the_next_goal_begins():
    belief = belief_with([(13.0, 10.0), (16.0, 10.0)])
    route = Route(belief, CFG)
    route.follow([dot(belief, 0), dot(belief, 1)], 0.0)
    assert not route.update(1.0)
    see(belief, 0)
    assert route.update(2.0)
    assert belief.goal_index == 1
    assert belief.goal == pytest.approx((16.0, 10.0), abs=0.1)


def test_the_vehicle_aims_at_what_is_left_of_a_cluster():
    belief = belief_with([(13.0, 10.0)])
    see(belief, 0, share=0.5)  # the southern half
    route = Route(belief, CFG)
    route.follow([dot(belief, 0)], 0.0)
    assert belief.goal[1] > 10.05


def test_what_cannot_be_seen_is_given_up_after_some_patience():
    belief = belief_with([(11.0, 10.0)])
    route = Route(belief, CFG)
    route.follow([dot(belief, 0)], 0.0)
    assert not any(route.update(t) for t in np.arange(0.0, CFG.patience_s, 0.5))
    assert route.update(CFG.patience_s + 0.6)
    assert route.goals == ()
    assert belief.track(0).visited
    assert belief.track(0).inspected == 0.0
    assert "could not be seen" in belief.last_failure[1]


def test_a_waypoint_is_done_near_it_and_sooner_when_another_goal_follows():
    belief = belief_with([])
    route = Route(belief, CFG)
    belief.pose = Pose(8.5, 10.0, 0.0)
    route.follow([Goal(x=10.0, y=10.0)], 0.0)
    assert not route.update(0.1)
    route.follow([Goal(x=10.0, y=10.0), Goal(x=14.0, y=10.0)], 0.2)
    assert route.update(0.3)
    assert belief.goal == (14.0, 10.0)


def test_a_waypoint_of_a_look_is_passed_as_near_as_it_says():
    belief = belief_with([])
    route = Route(belief, CFG)
    belief.pose = Pose(8.5, 10.0, 0.0)
    route.follow([Goal(x=10.0, y=10.0, pass_m=0.8), Goal(x=14.0, y=10.0)], 0.0)
    assert route.looking
    assert not route.update(0.1)
    belief.pose = Pose(9.3, 10.0, 0.0)
    assert route.update(0.2)
    assert not route.looking


def test_a_waypoint_that_was_to_show_water_is_done_when_all_of_it_has_been_seen():
    explored = np.ones((400, 400), bool)
    explored[:, 260:] = False
    belief = belief_with([], explored=explored)
    route = Route(belief, CFG)
    route.follow([Goal(x=14.0, y=10.0)], 0.0)
    assert not route.update(0.1)
    belief.map.explored[:] = True
    assert route.update(0.2)


def test_a_waypoint_that_showed_nothing_twice_is_not_worth_exploring():
    explored = np.ones((400, 400), bool)
    explored[:, 290:] = False
    belief = belief_with([], explored=explored)
    route = Route(belief, CFG)
    for shown, worth in (0, True), (20, True), (0, False):
        belief.pose = Pose(10.0, 10.0, 0.0)
        route.follow([Goal(x=14.0, y=10.0)], 0.0)
        assert not route.update(0.1)
        belief.pose = Pose(13.9, 10.0, 0.0)
        belief.map.explored[:, 290 : 290 + shown] = True
        assert route.update(0.2)
        assert belief.worth_exploring(14.2, 10.0) == worth
    assert belief.worth_exploring(17.0, 10.0)
    assert belief.failures(14.0, 10.0) == 0  # a cluster there is still worth a goal
    assert not belief.snapshot().worth_exploring(14.2, 10.0)


def test_the_arrival_is_where_the_robot_is_when_the_answer_comes():
    belief = belief_with([])
    route = Route(belief, RouteCfg(cruise_m_s=0.5, margin_s=0.0, reach_m=0.01, expected_latency_s=4.0))
    route.follow([Goal(x=11.0, y=10.0), Goal(x=11.0, y=15.0)], 0.0)
    arrival = route.arrival(None)
    assert arrival.in_s == pytest.approx(4.0, abs=0.5)
    assert arrival.pose == pytest.approx((11.0, 11.0, math.pi / 2), abs=0.3)
    assert arrival.goals == (Goal(x=11.0, y=10.0),)  # the second goal may still be changed


def test_the_expected_latency_is_the_median_of_the_last_answers():
    route = Route(belief_with([]), RouteCfg(expected_latency_s=10.0, margin_s=1.0))
    assert route.lead_s == 11.0
    for seconds in (3.0, 100.0, 5.0):
        route.answered(seconds)
    assert route.lead_s == 6.0


def test_the_aim_is_the_part_that_is_reached_first():
    left = np.array([[3.0, 0.0], [3.2, 0.0], [-2.5, 0.0]])
    assert aim(left, Pose(0.0, 0.0, 0.0), 0.75) == pytest.approx((3.1, 0.0))
    assert aim(left, Pose(0.0, 0.0, math.pi), 0.75) == pytest.approx((-2.5, 0.0))


def test_a_drive_past_a_cluster_shows_what_lies_ahead_and_near():
    belief = belief_with([(13.0, 10.0)])
    track = belief.track(0)
    path = np.array([[10.0, 10.0, 0.0], [11.5, 10.0, 0.0]])
    assert len(passed(track, path, 2.3)) == 0
    assert len(passed(track, path, 1.0)) == len(track.left)
    backwards = np.array([[13.0, 8.0, -math.pi / 2]])
    assert len(passed(track, backwards, 3.0)) == len(track.left)


def test_a_look_is_done_once_the_robot_faces_what_it_looks_at():
    belief = belief_with([])
    route = Route(belief, CFG)
    route.follow([Goal(x=10.0, y=10.0, pass_m=0.3, face=(10.0, 12.0))], 0.0)
    belief.pose = Pose(10.1, 10.0, 0.0)
    assert not route.update(0.1)
    assert route.turn_rad(CostField.straight((40, 40), (1.0, 1.0), cell_m=0.5)) == pytest.approx(math.pi / 2, abs=0.1)
    belief.pose = Pose(10.1, 10.0, math.pi / 2)
    assert route.update(0.2)
    assert route.goals == ()


def test_a_waypoint_lies_clear_of_what_no_answer_chose():
    belief = belief_with([(13.0, 10.0), (16.0, 10.0)])
    route = Route(belief, CFG, clear_m=2.5)
    route.follow([Goal(x=12.5, y=10.0)], 0.0)
    route.update(0.1)
    assert math.dist(belief.goal, (13.0, 10.0)) == pytest.approx(2.5, abs=0.1)
    route.follow([dot(belief, 0)], 0.2)
    route.update(0.3)
    assert len(belief.unchosen) == 1
    assert belief.unchosen[0] == pytest.approx((16.0, 10.0), abs=0.1)
    assert math.dist(belief.goal, (13.0, 10.0)) < 0.6


def test_beside_what_it_is_not_going_to_the_robot_first_turns_to_its_way():
    belief = belief_with([(12.4, 10.0)])
    route, field = Route(belief, CFG, clear_m=2.5), CostField.straight((400, 400), (10.0, 14.0), cell_m=0.05)
    belief.pose = HERE
    route.follow([Goal(x=10.0, y=14.0)], 0.0)
    route.update(0.1)
    assert route.turn_rad(field) == pytest.approx(math.pi / 2, abs=0.1)
    belief.pose = Pose(8.9, 10.0, 0.0)
    assert route.turn_rad(field) == 0.0  # from farther away the bow does not lead over it
    belief.pose = Pose(10.0, 10.0, math.pi / 2)
    assert route.turn_rad(field) == 0.0
    route.follow([dot(belief, 0)], 0.2)
    route.update(0.3)
    assert route.turn_rad(field) == 0.0


def test_a_goal_is_moved_to_the_side_of_the_robot_where_it_lies_in_the_middle():
    assert moved_clear((10.0, 10.0), [], 2.0, (0.0, 10.0)) == (10.0, 10.0)
    assert moved_clear((10.0, 10.0), [(10.0, 10.1)], 2.0, (0.0, 10.1)) == pytest.approx((8.0, 10.1))
    assert moved_clear((11.0, 10.0), [(10.0, 10.0)], 2.0, (0.0, 10.0)) == pytest.approx((12.0, 10.0))
