"""The facts of a question: geometry in the robot frame, as the planner asks for them."""

import json
import math

import numpy as np
import pytest

from coral.advisor.question import Rejection
from coral.reef.decide.planner import PlannerCfg
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Component
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label, Pose

NORTH = Pose(10.0, 10.0, 0.5 * math.pi)
CAMERA = CameraCfg()
SHAPE = (CAMERA.height, CAMERA.width)
BARE = Frame(
    depth=np.full(SHAPE, 5.0, np.float32),
    labels=np.full(SHAPE, Label.SEABED, np.uint8),
    instances=np.full(SHAPE, -1, np.int32),
)
"""Bare seabed, 5 m of it in sight."""


def belief(*clusters, pose=NORTH):
    """A robot in the middle of 20 x 20 m after its first picture, of bare seabed."""
    made = Belief(OccupancyMap((20.0, 20.0), CAMERA))
    made.update(BARE, pose)
    made.tracker.update([Component(x=x, y=y, area_px=200, length_m=1.0) for x, y in clusters])
    return made


def facts(made, rejections=(), **changes):
    planner = TourPlanner(made, CostFieldCfg(), lambda outlook: (), PlannerCfg(**changes))
    return planner.ask(planner.outlook(), rejections).question.facts


def test_facts_hold_plain_json_and_no_ground_truth():
    asked = [
        facts(belief((10.0, 14.0)), [Rejection(code="x", reason="no")]),
        facts(belief((10.0, 14.0)), centroid_selection=False),
    ]
    for shown in asked:
        text = json.dumps(shown, allow_nan=False)
        assert json.loads(text) == shown
        assert "cluster" not in text


def test_after_a_first_picture_of_bare_seabed_there_are_frontiers_and_no_dots():
    shown = facts(belief())
    assert shown["robot"] == {"x": 10.0, "y": 10.0, "theta": NORTH.theta}
    assert shown["area_m"] == [20.0, 20.0]
    assert shown["centroids"] == []
    assert "trend_deg" not in shown
    assert shown["frontiers"]
    assert all(f["reef_m"] is None for f in shown["frontiers"])


def test_dots_lie_forward_and_left_of_the_robot():
    (dot,) = facts(belief((7.0, 14.0)))["centroids"]  # heading north: 4 m forward, 3 m to the west
    assert (dot["forward_m"], dot["left_m"]) == pytest.approx((4.0, 3.0))
    assert dot["bearing_deg"] == pytest.approx(math.degrees(math.atan2(3.0, 4.0)), abs=0.1)
    assert dot["trajectory_m"] == pytest.approx(5.0)
    assert 5.0 <= dot["path_m"] < 5.5


def test_a_dot_that_no_known_way_leads_to_has_no_path():
    made = belief((10.0, 14.0), (10.0, 6.0))
    made.map.obstacle[240:244] = True
    paths = {round(dot["forward_m"]): dot["path_m"] for dot in facts(made)["centroids"]}
    assert paths[4] is None
    assert paths[-4] == pytest.approx(4.0, abs=0.3)


def steps(made, **changes):
    """The waypoints on offer, with the lengths of their paths."""
    shown = facts(made, centroid_selection=False, **changes)["options"]
    return {(o["forward_m"], o["left_m"]): o["path_m"] for o in shown}


def test_options_are_whole_metres_to_water_that_can_be_reached():
    made = belief(pose=Pose(10.0, 10.0, 0.0))
    made.map.obstacle[:, 240:244] = True  # a wall across the water 2 m ahead
    found = steps(made, step_m=3, separation_m=1.5)
    assert set(found) == {(f, s) for f in (-3, -2, -1, 0, 1) for s in range(-3, 4) if math.hypot(f, s) >= 1.5}
    assert all(path == pytest.approx(math.hypot(*step), rel=0.2) for step, path in found.items())


def test_options_end_at_the_edge_of_the_area():
    made = belief(pose=Pose(10.0, 18.5, 0.0))
    found = steps(made, step_m=3)
    assert max(left for _, left in found) == 1
