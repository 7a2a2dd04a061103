import math

import numpy as np
import pytest

from coral.reef.drive.traffic import Traffic, TrafficCfg, lower_to_path
from coral.reef.vehicle.fleet import Neighbour
from coral.reef.world.geometry import Pose

CELL = 0.05


def other(x, y, goal=None, path=(), times=()):
    return Neighbour(
        pose=Pose(x, y, 0.0),
        radius_m=0.3,
        goal=goal,
        path=np.array(path, float).reshape(-1, 2),
        times=np.array(times, float),
    )


def open_water(side=200):
    return np.full((side, side), np.inf, np.float32)


def at(distance, x, y):
    return float(distance[int(y / CELL), int(x / CELL)])


def test_distances_to_a_line_are_those_of_its_band():
    distance = open_water()
    lower_to_path(distance, CELL, np.array([(3.0, 5.0), (6.0, 5.0)]), 0.4, 1.2)
    assert at(distance, 4.51, 5.01) == 0.0
    assert at(distance, 4.51, 6.01) == pytest.approx(0.6, abs=CELL)
    assert at(distance, 7.01, 5.01) == pytest.approx(0.6, abs=CELL)
    assert math.isinf(at(distance, 4.51, 7.51))


def test_the_shared_distances_stay_as_they_are():
    distance = open_water()
    own = Traffic().stamped(distance, CELL, Pose(2.0, 5.0, 0.0), [other(5.0, 5.0)])
    assert np.isinf(distance).all()
    assert at(own, 5.01, 5.01) == 0.0


def test_only_the_next_seconds_of_a_plan_are_reserved():
    ahead = other(5.0, 5.0, path=[(5.0, 5.0), (6.0, 5.0), (7.0, 5.0)], times=[0.0, 1.0, 4.0])
    own = Traffic(TrafficCfg(reserve_s=2.0)).stamped(open_water(), CELL, Pose(1.0, 5.0, 0.0), [ahead])
    assert at(own, 5.99, 5.01) == 0.0
    assert at(own, 7.01, 5.01) > 0.5


def test_a_plan_that_leads_into_this_robot_is_reserved_up_to_it():
    towards = other(5.0, 5.0, path=[(4.0, 5.0), (2.0, 5.0)], times=[0.5, 1.5])
    line = Traffic().reserved(towards, Pose(2.0, 5.0, 0.0))
    assert line.tolist() == [[5.0, 5.0], [4.0, 5.0]]


@pytest.mark.parametrize(
    ("theta", "speed", "x", "expected"),
    [(0.0, 0.1, 0.70, 0.0), (math.pi, -0.1, 0.70, 0.0), (math.pi, 0.1, 0.70, 0.1), (0.0, 0.1, 0.80, 0.1)],
)
def test_a_robot_does_not_drive_towards_one_that_is_close(theta, speed, x, expected):
    assert Traffic().held((speed, 0.2), Pose(0.0, 0.0, theta), [other(x, 0.0)]) == (expected, 0.2)


def test_a_target_is_taken_by_its_label_or_by_its_place():
    going = Neighbour(pose=Pose(0.0, 0.0, 0.0), radius_m=0.3, goal=(4.0, 0.0), index=7)
    assert going.is_going_to(9.0, 9.0, 7, 1.0)
    assert going.is_going_to(4.5, 0.0, None, 1.0)
    assert not going.is_going_to(9.0, 9.0, 8, 1.0)
    assert going.distance_m(3.0, 0.0) == 1.0
    assert not other(0.0, 0.0).is_going_to(0.0, 0.0, None, 1.0)
