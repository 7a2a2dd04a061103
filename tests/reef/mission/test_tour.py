import dataclasses
import math

import numpy as np
import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.oracle import plan_tour
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.tour import LanesPilot, along, drive_lines, lanes
from coral.reef.mission.variants import apply_variant
from coral.reef.mission.word_judge import with_instruction
from coral.reef.simulation.imaging import ImagingCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.tour_kernels import advance, follow
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Pose

QUIET = MissionCfg(time_limit_s=300.0, record=RecordCfg(pictures=False, frames=False))


def test_lanes_lie_evenly_and_leave_nothing_farther_than_half_a_spacing():
    for height in (9.0, 20.0, 22.0, 27.0, 30.0):
        ys = sorted({y for _, y in lanes((20.0, height), 10.0, Pose(1, 1, 0))[1:].tolist()})
        assert np.diff(ys) == pytest.approx([10.0] * (len(ys) - 1))
        assert ys[0] <= 5.0 + 1e-9
        assert ys[-1] >= height - 5.0 - 1e-9


def test_lanes_begin_at_the_corner_next_to_the_start():
    assert lanes((20, 20), 10.0, Pose(2, 3, 0)).tolist() == [[2, 3], [1, 5], [19, 5], [19, 15], [1, 15]]
    assert lanes((20, 20), 10.0, Pose(18, 17, 0)).tolist() == [[18, 17], [19, 15], [1, 15], [1, 5], [19, 5]]


def test_points_along_lanes_are_near_each_other_and_end_where_the_lanes_do():
    points = along(np.array([(0.0, 0.0), (0.0, 9.0), (4.0, 9.0)]), 4.0)
    assert points == [(0.0, 3.0), (0.0, 6.0), (0.0, 9.0), (4.0, 9.0)]


def test_a_lawnmower_drives_around_what_stands_on_its_lanes(pond, tmp_path):
    cfg = apply_variant("lawnmower", dataclasses.replace(QUIET, lane_m=5.0))
    mission = Mission(pond, cfg, RuleAdvisor(REEF_RULES), tmp_path / "run")
    assert isinstance(mission.pilot, LanesPilot)
    found = mission.run()
    assert (found["end_reason"], found["advisor_calls"], found["collisions"]) == ("all lanes are done", 0, 0)
    assert found["distance_m"] > 0.4 * found["sim_time_s"]
    assert found["coverage"] == 1.0


def test_a_lawnmower_that_is_called_home_leaves_its_lanes(pond, tmp_path):
    mission = Mission(pond, apply_variant("lawnmower", QUIET), RuleAdvisor(REEF_RULES), tmp_path / "run")
    for _ in range(100):
        mission.advance()
    mission.pilot.go_home(2.0, 2.0)
    for _ in range(600):
        mission.advance()
    assert mission.belief.goal == (2.0, 2.0)
    assert math.dist(mission.belief.pose[:2], (2.0, 2.0)) < 1.0
    assert mission.pilot.end_reason == ""


def test_a_lawnmower_ends_a_mission_in_words_at_the_start(pond, tmp_path):
    quiet = dataclasses.replace(QUIET, lane_m=5.0)
    start, ends = (pond.start.x, pond.start.y), []
    for k, cfg in enumerate((quiet, with_instruction(quiet, "Look for a tyre and come back.", None))):
        pilot = Mission(pond, apply_variant("lawnmower", cfg), RuleAdvisor(REEF_RULES), tmp_path / str(k)).pilot
        ends.append(math.dist(pilot.points[-1], start))
    assert ends[0] > 5.0
    assert ends[1] == 0.0


def test_lanes_in_a_mission_in_words_end_with_the_word_that_it_is_done(pond, tmp_path):
    cfg = with_instruction(apply_variant("lawnmower", dataclasses.replace(QUIET, lane_m=5.0)), "Look, and come back.")
    mission = Mission(pond, cfg, RuleAdvisor(REEF_RULES), tmp_path / "run")
    found = mission.run()
    assert (found["end_reason"], found["advisor_calls"], mission.answer) == ("all lanes are done", 0, "")
    assert math.dist(mission.belief.pose[:2], (pond.start.x, pond.start.y)) < 2.0


def test_a_unicycle_drives_arcs_of_circles():
    assert advance(0.0, 0.0, 0.0, 0.6, 0.0, 0.5) == (0.3, 0.0, 0.0)
    x, y, theta = advance(0.0, 0.0, 0.0, 0.6, 0.6, math.pi / 1.2)
    assert (x, y, theta) == pytest.approx((1.0, 1.0, math.pi / 2))  # a quarter of a circle of 1 m


def twin(start, path, speed, rate, dt, most):
    """`follow` again, in plain Python: aim 0.3 m on, slower the more the heading is off."""
    x, y, theta = start
    aim, last, commands = 0, len(path) - 1, []
    while len(commands) < most:
        aim = next((i for i in range(aim, last) if math.hypot(path[i][0] - x, path[i][1] - y) >= 0.3), last)
        left = math.hypot(path[aim][0] - x, path[aim][1] - y)
        if aim == last and left < 0.05:
            break
        error = math.remainder(math.atan2(path[aim][1] - y, path[aim][0] - x) - theta, 2 * math.pi)
        omega = max(-rate, min(rate, error / dt))
        v = speed * max(0.0, 1 - abs(error) / 0.6)
        v = min(v, left / dt) if aim == last else v
        x, y, theta = advance(x, y, theta, v, omega, dt)
        commands.append((v, omega))
    return commands


def test_following_equals_its_plain_twin():
    corner = np.concatenate([np.linspace((0, 0), (3, 0), 61), np.linspace((3, 0), (3, -2), 41)[1:]])
    commands, poses = np.zeros((500, 2)), np.zeros((500, 3))
    n = follow((0.0, 0.0, 1.0), corner, 0.6, 0.6, 0.1, 500, commands, poses)
    np.testing.assert_allclose(commands[:n], twin((0.0, 0.0, 1.0), corner.tolist(), 0.6, 0.6, 0.1, 500), atol=1e-9)
    assert math.dist(poses[n - 1, :2], (3, -2)) < 0.06
    assert min(np.hypot(*(corner - p[:2]).T).min() for p in poses[:n]) < 0.1
    off = max(float(np.hypot(*(corner - p[:2]).T).min()) for p in poses[:n])
    assert off < 0.12


def test_a_hairpin_is_driven_to_its_end():
    there_and_back = np.concatenate([np.linspace((0, 0), (3, 0), 61), np.linspace((3, 0), (0, 0.05), 61)[1:]])
    commands, poses = np.zeros((500, 2)), np.zeros((500, 3))
    n = follow((0.0, 0.0, 0.0), there_and_back, 0.6, 0.6, 0.1, 500, commands, poses)
    assert n < 300
    assert max(poses[:n, 0]) > 2.6


def test_a_kinematic_vehicle_drives_what_was_planned():
    start = Pose(2.0, 3.0, 0.4)
    commands = drive_lines(lanes((12.0, 12.0), 6.0, start), start, VehicleCfg(), 0.1)
    planned = [start]
    for v, omega in commands:
        planned.append(Pose(*advance(*planned[-1], v, omega, 0.1)))
    vehicle = VehicleDynamics(VehicleCfg(model="kinematic"), VehicleState(*start))
    for v, omega in commands:
        trace = vehicle.step((v, omega), 0.1, current=(0.3, 0.3))
        assert trace.shape == (5, 2)
    assert vehicle.state[:2] == pytest.approx(planned[-1][:2], abs=1e-6)
    assert math.remainder(vehicle.state.theta - planned[-1].theta, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)


def test_the_oracle_is_a_mission_like_any_other(pond, tmp_path):
    result = Mission(pond, apply_variant("oracle", QUIET), RuleAdvisor(REEF_RULES), tmp_path / "run").run()
    tour = plan_tour(pond, CameraCfg(), ImagingCfg(), None, VehicleCfg())
    assert (result["collisions"], result["advisor_calls"], result["end_reason"]) == (0, 0, "the tour is done")
    assert result["inspected"] > 0.99
    assert result["time_to_90_s"] == tour.time_to(0.9)
    assert result["oracle_ratio_90"] == 1.0
