"""DDP-MPPI: the paper's schedules, the rollout kernel against a plain NumPy twin, and behaviour on small maps."""

import dataclasses
import math

import cv2
import numpy as np
import pytest
from given_fields import field_to

from coral.errors import InputError
from coral.reef.drive.controller import (
    NO_FEASIBLE,
    NOT_FINITE,
    DdpMppi,
    MppiCfg,
    boundary_points,
    intervals,
    schedule,
    shift_matrix,
)
from coral.reef.drive.controller_kernels import (
    RolloutScene,
    rollout,
)
from coral.reef.drive.cost_terms import COSTS, GOAL, PATH, SPEED, CostCfg, Scales
from coral.reef.map.costfield import UNREACHABLE, CostField
from coral.reef.vehicle.dynamics import Thrusters, planar
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState

CELL = 0.05
MODEL = planar(Thrusters())
SIMULATED = VehicleResponse.of_vehicle(VehicleCfg())
SLUGGISH = VehicleResponse(surge_lag_s=0.15, yaw_lag_s=0.3, trail=0.3, trail_lag_s=2.0)
OPEN = np.full((240, 240), np.inf, np.float32)


def discs(*circles, size=240):
    obstacle = np.zeros((size, size), np.uint8)
    for x, y, r in circles:
        cv2.circle(obstacle, (round(x / CELL), round(y / CELL)), round(r / CELL), 1, -1)
    return cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL)


def scene_of(distance, field, **changes):
    scene = RolloutScene(distance, CELL, field.value, field.cell_m, 0.3, 0.08, 4.0, Scales(0.4, 0.3, 3.0, 0.6, 0.6))
    return scene._replace(**changes)


def run(start, controls, scene, cfg=None, guide=None, response=SIMULATED):
    table = schedule(cfg or MppiCfg(), response)
    k, n = controls.shape[:2]
    path, costs, ok = np.empty((k, n + 1, 3)), np.empty((k, len(COSTS))), np.empty(k, np.bool_)
    rollout(
        np.array([*start, 0.0, 0.0][:8], dtype=float), np.zeros(2), controls,
        np.zeros(k) if guide is None else guide, table, scene,
        MODEL, path, costs, ok,
    )  # fmt: skip
    return path, costs, ok


def test_intervals_of_eq_10():
    dt = intervals(5.0, 10, 1.7)
    assert dt.sum() == pytest.approx(5.0)
    assert dt[0] == pytest.approx(0.1, abs=3e-4)  # the control period
    assert dt[-1] == pytest.approx(0.82, abs=1e-3)
    assert np.all(np.diff(dt) > 0)
    assert intervals(5.0, 10, 1.0) == pytest.approx(np.full(10, 0.5))


def test_boundary_points_of_eq_11():
    assert boundary_points(32, 10, 1.7).tolist() == [32, 32, 30, 28, 26, 23, 19, 15, 11, 6]


def test_the_uniform_ablation_keeps_every_point_and_step():
    table = schedule(MppiCfg(uniform=True), SIMULATED)
    assert table.dt == pytest.approx(np.full(10, 0.5))
    assert table.points.tolist() == [32] * 10
    assert table.substeps.tolist() == [10] * 10


def test_shift_keeps_constants_and_moves_a_uniform_sequence_by_its_step():
    dt = intervals(5.0, 10, 1.7)
    shift = shift_matrix(dt, 0.1)
    assert shift.sum(axis=1) == pytest.approx(np.ones(10))
    uniform = shift_matrix(np.full(4, 0.1), 0.1)
    assert uniform @ np.array([1.0, 2.0, 3.0, 4.0]) == pytest.approx([2.0, 3.0, 4.0, 4.0])


def numpy_rollout(start, controls, table, distance, response, hull=0.3, margin=0.08):
    """Twin of `rollout`: one sequence, every boundary point at every check, plain NumPy and math."""
    x, y, th, u, v, r = start[:6]
    trailing = np.array(start[6:] or (0.0, 0.0))
    poses, free = [(x, y, th)], True

    def blocked(px, py, n):
        points = [(px, py)]
        points += [
            (px + hull * math.cos(2 * math.pi * k / n), py + hull * math.sin(2 * math.pi * k / n)) for k in range(n)
        ]
        for qx, qy in points:
            size = distance.shape[0] * CELL
            if min(qx, qy, size - qx, size - qy) <= margin or distance[int(qy / CELL), int(qx / CELL)] <= margin:
                return True
        return False

    m = MODEL
    for t, (cv, cw) in enumerate(controls):
        h = table.dt[t] / table.substeps[t]
        surge, yaw = (1 - math.exp(-h / response.surge_lag_s)) / h, (1 - math.exp(-h / response.yaw_lag_s)) / h
        for _ in range(table.substeps[t]):
            nu = np.array([u, v, r])
            mass = np.array([m.m11, m.m22, m.m66])
            drag = np.array([m.du, m.dv, m.dr]) + np.array([m.duu, m.dvv, m.drr]) * np.abs(nu)
            coriolis = np.array([-m.m22 * v * r, m.m11 * u * r, (m.m22 - m.m11) * u * v])
            rates = np.array([surge, surge, yaw])
            ahead, left = np.array([math.cos(th), math.sin(th)]), np.array([-math.sin(th), math.cos(th)])
            follow = np.array([(1 - response.trail) * cv + ahead @ trailing, left @ trailing, cw])
            wanted = mass * rates * (follow - nu) + drag * nu + coriolis
            n = np.clip(wanted[2], -m.thrust_max * m.moment_arm, m.thrust_max * m.moment_arm)
            left = m.thrust_max - abs(n / m.moment_arm)
            fy = np.clip(wanted[1], -left * m.force_arm, left * m.force_arm)
            left -= abs(fy / m.force_arm)
            fx = np.clip(wanted[0], -left * m.force_arm, left * m.force_arm)
            new = nu + h * (np.array([fx, fy, n]) - drag * nu - coriolis) / mass
            trailing += (1 - math.exp(-h / response.trail_lag_s)) * (response.trail * cv * ahead - trailing)
            um, vm, rm = 0.5 * (nu + new)
            heading = th + 0.5 * h * rm
            dx = h * (math.cos(heading) * um - math.sin(heading) * vm)
            dy = h * (math.sin(heading) * um + math.cos(heading) * vm)
            if math.hypot(dx, dy) > CELL and blocked(x + dx / 2, y + dy / 2, table.points[t]):
                free = False
            if blocked(x + dx, y + dy, table.points[t]):
                free = False
            x, y, th, (u, v, r) = x + dx, y + dy, th + h * rm, new
            if not free:
                return poses, False
        poses.append((x, y, th))
    return poses, True


@pytest.mark.parametrize("response", [SIMULATED, SLUGGISH], ids=["simulated", "sluggish"])
def test_rollouts_match_the_numpy_twin(response):
    rng = np.random.default_rng(5)
    distance = discs((6.0, 7.5, 0.5), (7.5, 6.0, 0.4), (5.0, 4.5, 0.3))
    field = field_to((10.0, 10.0), distance)
    start = (6.0, 6.0, 0.7, 0.4, 0.05, -0.2, *(response.trail * np.array([0.3, 0.2])))
    controls = np.stack([rng.uniform(0, 0.6, (60, 10)), rng.uniform(-0.6, 0.6, (60, 10))], axis=2)
    path, _, ok = run(start, controls, scene_of(distance, field), response=response)
    table = schedule(MppiCfg(), response)
    assert 10 < ok.sum() < 50
    for k in range(60):
        poses, free = numpy_rollout(start, controls[k], table, distance, response)
        assert free == ok[k]
        assert path[k, : len(poses)] == pytest.approx(np.array(poses), abs=1e-5)


def test_coarse_rollouts_stay_close_to_the_simulated_vehicle():
    """The variable-fidelity model against the vehicle with lag, RK4 and its own velocity loop."""
    rng = np.random.default_rng(2)
    field = CostField.straight((240, 240), (10.0, 6.0))
    controls = np.stack([rng.uniform(0, 0.6, (10, 10)), rng.uniform(-0.6, 0.6, (10, 10))], axis=2)
    path, _, _ = run((6.0, 6.0, 0.3, 0.3, 0.0, 0.1), controls.copy(), scene_of(OPEN, field))
    dt = schedule(MppiCfg(), SIMULATED).dt
    for k in range(10):
        vehicle = VehicleDynamics(VehicleCfg(), VehicleState(6.0, 6.0, 0.3, 0.3, 0.0, 0.1))
        for t in range(10):
            vehicle.step(tuple(controls[k, t]), dt=dt[t])
            s = vehicle.state
            assert math.hypot(s.x - path[k, t + 1, 0], s.y - path[k, t + 1, 1]) < 0.08


def test_a_thin_obstacle_between_two_steps_is_seen():
    distance = discs((6.75, 6.0, 0.0))
    field = CostField.straight((240, 240), (10.0, 6.0))
    controls = np.tile([0.6, 0.0], (1, 10, 1))
    _, _, ok = run((6.0, 6.0, 0.0, 0.6, 0, 0), controls, scene_of(distance, field))
    assert not ok[0]


def test_obstacles_beyond_the_sensing_range_do_not_count():
    distance = discs((7.5, 6.0, 0.3))
    field = CostField.straight((240, 240), (10.0, 6.0))
    controls = np.tile([0.6, 0.0], (1, 10, 1))
    near = run((6.0, 6.0, 0.0, 0.6, 0, 0), controls, scene_of(distance, field))[2]
    far = run((6.0, 6.0, 0.0, 0.6, 0, 0), controls, scene_of(distance, field, range_m=0.3))[2]
    assert (bool(near[0]), bool(far[0])) == (False, True)


def test_the_edge_of_the_map_stops_rollouts():
    field = CostField.straight((240, 240), (1.0, 6.0))
    controls = np.tile([0.6, 0.0], (1, 10, 1))
    assert not run((1.0, 6.0, math.pi, 0.6, 0, 0), controls, scene_of(OPEN, field))[2][0]


def test_cost_terms_of_a_straight_drive_match_hand_values():
    field = CostField.straight((240, 240), (11.0, 6.0))
    controls = np.zeros((2, 10, 2))
    controls[0, :, 0] = 0.6
    costs = run((3.0, 6.0, 0.0, 0.6, 0, 0), controls, scene_of(OPEN, field))[1]
    # driving 3 m of a reach of 3 m: the end is a full reach nearer, the mean along the way (right sums) over half
    dt = intervals(5.0, 10, 1.7)
    mean = float((np.cumsum(dt) * 0.6 * dt).sum() / 5.0)
    assert costs[0, GOAL] == pytest.approx(0.5 * (-3.0 - mean) / 3.0, abs=0.01)
    assert costs[0, SPEED] == pytest.approx(0.0, abs=1e-6)
    assert costs[0, PATH] == pytest.approx(0.0, abs=0.01)
    # standing: the 0.15 m it takes to stop are small against the reach
    assert costs[1, GOAL] == pytest.approx(-0.05, abs=0.01)
    assert costs[1, SPEED] > 0.9


def test_guided_rollouts_steer_themselves_around():
    distance = discs((6.0, 6.0, 0.8))
    field = field_to((9.0, 6.0), distance)
    controls = np.zeros((1, 10, 2))
    path, _, ok = run((4.0, 6.0, 0.0, 0.3, 0, 0), controls, scene_of(distance, field), guide=np.array([0.6]))
    assert ok[0]
    assert field.lookup(*path[0, -1, :2]) < field.lookup(4.0, 6.0) - 1.2
    assert np.abs(controls[0, :, 1]).max() > 0.05  # what it chose is written back


def go(controller, distance, start, goal, seconds, cfg=None):
    field = field_to(goal, distance, start=start[:2])
    vehicle, trace, plans = VehicleDynamics(cfg, VehicleState(*start)), [], []
    for _ in range(round(seconds / 0.1)):
        plans.append(controller.plan(vehicle.state, field, distance))
        trace.extend(vehicle.step(plans[-1].command))
        if math.dist(vehicle.state[:2], goal) < 0.3:
            break
    return vehicle, np.array(trace), plans


def test_drives_around_an_obstacle_without_touching_it_and_holds_at_the_goal():
    distance = discs((6.0, 6.0, 0.8))
    controller = DdpMppi(rng=np.random.default_rng(1))
    vehicle, trace, plans = go(controller, distance, (3.0, 6.0, 0.0), (9.0, 6.0), 30.0)
    assert math.dist(vehicle.state[:2], (9.0, 6.0)) < 0.3
    assert len(plans) < 160
    assert np.hypot(trace[:, 0] - 6.0, trace[:, 1] - 6.0).min() > 1.1
    assert all(p.ok for p in plans)
    field = field_to((9.0, 6.0), distance)
    for _ in range(30):
        vehicle.step(controller.plan(vehicle.state, field, distance).command)
    assert math.dist(vehicle.state[:2], (9.0, 6.0)) < 0.4
    assert abs(vehicle.state.u) < 0.01


@pytest.mark.parametrize("period_s", [0.1, 0.25])
def test_the_warm_start_is_one_control_period_later(period_s):
    controller = DdpMppi(rng=np.random.default_rng(1), control_period_s=period_s)
    controller.plan(VehicleState(3.0, 6.0, 0.0, 0.3), field_to((9.0, 6.0), OPEN), OPEN)
    expected = shift_matrix(controller.schedule.dt, period_s) @ controller._nominal
    np.testing.assert_allclose(controller.warm_start(), expected)
    # Half an interval of 0.5 s later the first command is the mean of the first two of the old ones, and so on.
    assert not np.allclose(controller.warm_start(), controller._nominal)


def test_a_goal_behind_is_turned_to_on_a_small_circle():
    vehicle, trace, plans = go(DdpMppi(rng=np.random.default_rng(1)), OPEN, (6.0, 6.0, 0.0), (3.0, 6.0), 25.0)
    assert math.dist(vehicle.state[:2], (3.0, 6.0)) < 0.3
    assert trace[:, 0].max() < 6.6
    assert len(plans) < 150


def test_passes_a_gap_of_one_metre():
    distance = discs(
        *[(6.0, y, 0.3) for y in np.arange(0.0, 5.3, 0.3)], *[(6.0, y, 0.3) for y in np.arange(6.7, 12, 0.3)]
    )
    vehicle, trace, _ = go(DdpMppi(rng=np.random.default_rng(1)), distance, (3.0, 3.0, 1.0), (9.0, 6.0), 40.0)
    assert math.dist(vehicle.state[:2], (9.0, 6.0)) < 0.3
    assert min(distance[int(y / CELL), int(x / CELL)] for x, y in trace) > 0.3


def test_same_seed_same_plan_bit_for_bit():
    distance = discs((6.0, 6.0, 0.8))
    ends = [go(DdpMppi(rng=np.random.default_rng(7)), distance, (3.0, 6.0, 0.0), (9.0, 6.0), 5.0)[1] for _ in range(2)]
    assert np.array_equal(ends[0], ends[1])
    other = go(DdpMppi(rng=np.random.default_rng(8)), distance, (3.0, 6.0, 0.0), (9.0, 6.0), 5.0)[1]
    assert not np.array_equal(ends[0], other)


def test_a_failed_field_is_reported_and_stops():
    obstacle = np.zeros((240, 240), np.uint8)
    obstacle[:, 120:122] = 1
    distance = cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL)
    field = field_to((9.0, 6.0), distance, start=(3.0, 6.0))
    plan = DdpMppi().plan(VehicleState(3.0, 6.0, 0.0, 0.5), field, distance)
    assert (plan.ok, plan.failure, plan.command) == (False, UNREACHABLE, (0.0, 0.0))


def test_no_feasible_rollout_is_reported_and_brakes():
    """0.6 m/s at 3 cm from the margin cannot be stopped in time."""
    distance = discs((6.55, 6.0, 0.1))
    field = field_to((9.0, 6.0), distance)
    plan = DdpMppi().plan(VehicleState(6.0, 6.0, 0.0, 0.6, 0.0, 0.0), field, distance)
    assert (plan.ok, plan.failure) == (False, NO_FEASIBLE)
    assert plan.command[0] <= 0.0


@pytest.mark.parametrize(("gap", "creep"), [(0.36, 0.03), (0.31, 0.03), (0.25, 0.08)])
def test_a_robot_found_too_close_gets_away(gap, creep):
    """Closer than the margin (or even inside the hull, after drift) the robot must turn and leave, not freeze."""
    distance = discs((6.0 + gap + 0.3, 6.0, 0.3))
    controller = DdpMppi(rng=np.random.default_rng(1))
    vehicle, trace, _ = go(controller, distance, (6.0, 6.0, 0.0), (3.0, 6.0), 30.0)
    assert math.dist(vehicle.state[:2], (3.0, 6.0)) < 0.3
    assert trace[:, 0].max() < 6.0 + creep


@pytest.mark.parametrize("bearing", [0.0, 0.4, math.pi / 2, 2.8])
def test_a_speck_mapped_within_the_hull_does_not_hold_the_robot(bearing):
    """It lies among the points of the boundary, which are all clear of it."""
    speck = (6.0 + 0.17 * math.cos(bearing), 6.0 + 0.17 * math.sin(bearing))
    distance = discs((*speck, 0.0))
    controller = DdpMppi(rng=np.random.default_rng(1))
    vehicle, trace, _ = go(controller, distance, (6.0, 6.0, bearing + math.pi), (9.0, 6.0), 30.0)
    assert math.dist(vehicle.state[:2], (9.0, 6.0)) < 0.35
    assert np.hypot(*(trace[:, :2] - speck).T).min() > 0.17 - 0.08


@pytest.mark.parametrize("bearing", [2.24, 3.29, 4.48, 4.55])
def test_a_speck_that_only_later_steps_find_does_not_hold_the_robot(bearing):
    """It lies at the hull's boundary, beside the points that the first step checks."""
    distance = discs((6.0 + 0.305 * math.cos(bearing), 6.0 + 0.305 * math.sin(bearing), 0.0))
    vehicle, _, plans = go(DdpMppi(rng=np.random.default_rng(1)), distance, (6.0, 6.0, bearing + 0.3), (9.0, 6.0), 30.0)
    assert math.dist(vehicle.state[:2], (9.0, 6.0)) < 0.35
    assert plans[0].ok


def test_fewer_or_more_rollouts_and_steps_are_only_a_configuration():
    for cfg in (MppiCfg(n_rollouts=50, n_steps=5), MppiCfg(uniform=True), MppiCfg(costs=CostCfg(path=0.2))):
        vehicle, _, _ = go(DdpMppi(cfg, rng=np.random.default_rng(1)), OPEN, (4.0, 6.0, 0.0), (7.0, 6.0), 20.0)
        assert math.dist(vehicle.state[:2], (7.0, 6.0)) < 0.35


def test_a_frozen_configuration_can_be_varied():
    assert dataclasses.replace(MppiCfg(), n_rollouts=10).n_rollouts == 10


@pytest.mark.parametrize("share", [0.0, 0.1])
def test_few_or_no_guided_samples(share):
    planner = DdpMppi(MppiCfg(n_rollouts=20, guided_fraction=share, warm_fraction=0.0), rng=np.random.default_rng(0))
    field = field_to((9.0, 6.0), OPEN)
    assert planner.plan(VehicleState(6.0, 6.0, 0.0), field, OPEN).ok
    controls = planner._sample()
    assert np.all(np.abs(controls) <= 0.6)
    assert np.count_nonzero(np.abs(controls).sum(axis=(1, 2)) == 0.0) <= 1 + round(share * 20)


def test_rollouts_that_do_not_suffice_for_their_shares_are_refused():
    with pytest.raises(InputError, match="n_rollouts: found 20, expected at least 21"):
        MppiCfg(n_rollouts=20, warm_fraction=0.95, guided_fraction=0.0)
    MppiCfg(n_rollouts=20, warm_fraction=0.9, guided_fraction=0.0)


@pytest.mark.parametrize("bad", [{"r": math.nan}, {"u": math.inf}, {"x": math.nan}])
def test_one_state_that_is_not_finite_fails_and_spoils_no_later_plan(bad):
    controller, field = DdpMppi(rng=np.random.default_rng(1)), field_to((9.0, 6.0), OPEN)
    controller.plan(VehicleState(3.0, 6.0, 0.0), field, OPEN)
    failed = controller.plan(VehicleState(3.0, 6.0, 0.0)._replace(**bad), field, OPEN)
    assert (failed.ok, failed.command, failed.failure) == (False, (0.0, 0.0), NOT_FINITE)
    after = controller.plan(VehicleState(3.0, 6.0, 0.0), field, OPEN)
    assert after.ok
    assert np.isfinite(after.path).all()
