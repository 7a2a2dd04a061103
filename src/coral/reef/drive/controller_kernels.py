"""Rollouts of DDP-MPPI: propagation of variable fidelity and collision checks in one pass (numba).

Paper Eqs. 9 to 11 and Alg. 3. The fidelity of each step is a table made once (`Schedule`), so the ablation without DDP
is the same code with other numbers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.drive.cost_terms import Scales, Step, add_step, finish
from coral.reef.map.costfield_kernels import lookup
from coral.reef.vehicle.dynamics import Planar
from coral.reef.vehicle.dynamics_kernels import limit_wrench

Array = NDArray[np.float64]


class Schedule(NamedTuple):
    """Fidelity of each step of a rollout. Arrays have Shape=(T,)."""

    dt: Array
    """Interval of each step, Eq. 10 (s)."""
    substeps: NDArray[np.int64]
    """Integration steps in each interval."""
    rate: Array
    """(1 - exp(-k h)) / h: mean acceleration per unit of velocity error over one integration step h (1/s)."""
    yaw_rate: Array
    points: NDArray[np.int64]
    """Number of boundary points checked at each step, Eq. 11."""
    circle: Array
    """Unit vectors to those points. Shape=(T, n, 2)."""
    trail: float
    """Share of the wanted velocity that follows slowly, in the world frame; 0 with our own velocity loop."""
    trail_share: Array
    """1 - exp(-h / trail_lag) of one integration step."""


class RolloutScene(NamedTuple):
    """Grids of obstacle distances and cost-to-go, the hull, and the scales of the cost terms. World frame, metres."""

    distance: NDArray[np.float32]
    """Distance to the nearest known obstacle (m). Shape=(H, W)."""
    cell_m: float
    value: NDArray[np.float32]
    """Cost-to-go (m). Shape=(h, w)."""
    value_cell_m: float
    hull_m: float
    """Radius of the hull for the collision check."""
    margin_m: float
    """Clearance that every boundary point must keep."""
    range_m: float
    """Obstacles beyond this distance from the robot do not count."""
    scales: Scales
    """Its radius of the hull is the true one, even while `hull_m` is reduced."""


@njit(cache=True, error_model="numpy")
def clearance_at(distance: NDArray[np.float32], cell_m: float, x: float, y: float) -> float:
    """Return the distance (m) from a point to the nearest known obstacle or map edge; not positive outside the map."""
    h, w = distance.shape
    edge: float = min(min(x, w * cell_m - x), min(y, h * cell_m - y))
    if edge > 0.0:
        edge = min(edge, distance[int(y / cell_m), int(x / cell_m)])
    return edge


@njit(cache=True, error_model="numpy")
def turn(c: float, s: float, angle: float) -> tuple[float, float]:
    """Rotate (cos, sin) by an angle of at most 0.3 rad, by a Taylor series: accurate to 1e-6, faster than libm."""
    a2 = angle * angle
    ca, sa = 1.0 - a2 * (0.5 - a2 / 24.0), angle * (1.0 - a2 * (1.0 / 6.0 - a2 / 120.0))
    return c * ca - s * sa, s * ca + c * sa


@njit(cache=True, error_model="numpy")
def hull_is_free(scene: RolloutScene, x: float, y: float, circle: Array, n: int) -> bool:
    """Check whether n points on the hull's boundary (N_t of Eq. 11) all keep the margin.

    `circle`, Shape=(>=n, 2), holds unit vectors.
    """
    for k in range(n):
        px, py = x + scene.hull_m * circle[k, 0], y + scene.hull_m * circle[k, 1]
        if clearance_at(scene.distance, scene.cell_m, px, py) <= scene.margin_m:
            return False
    return True


@njit(cache=True, error_model="numpy")
def rollout(
    start: Array,
    previous: Array,
    controls: Array,
    guide_speed: Array,
    schedule: Schedule,
    scene: RolloutScene,
    model: Planar,
    path: NDArray[np.float64],
    costs: Array,
    feasible: NDArray[np.bool_],
) -> None:
    """Propagate K control sequences (Eq. 9) and score them.

    The model is that of the vehicle: velocity loop, thruster limits, drag and Coriolis terms. Within an integration
    step the loop's response is exact (exponential) as long as no thruster saturates, which keeps steps of 0.2 s stable.
    The thrust lag (0.03 s) is omitted.

    Args:
        start: Shape=(8,), x, y, theta, u, v, r, and the trailing velocity in the world frame.
        previous: Shape=(2,), command being executed, for the smoothness term.
        controls: Shape=(K, T, 2), speed and yaw rate. A guided rollout writes the commands that it chose.
        guide_speed: Shape=(K,). If positive, the rollout steers down the cost-to-go at about this speed, and its row of
            `controls` is a perturbation of that.
        schedule: Fidelity of each step.
        scene: Map, cost-to-go and scales.
        model: Constants of the vehicle.
        path: Shape=(K, T + 1, 3), written: poses at the ends of the steps.
        costs: Shape=(K, len(COSTS)), written: normalised cost terms.
        feasible: Shape=(K,), written: whether the rollout stays clear of obstacles.
    """
    n_rollouts, n_steps = controls.shape[0], controls.shape[1]
    x0, y0 = start[0], start[1]
    v0 = lookup(scene.value, scene.value_cell_m, x0, y0)[0]
    c0, s0 = math.cos(start[2]), math.sin(start[2])
    horizon, at_once = schedule.dt.sum(), 1.0 - schedule.trail
    inv_m11, inv_m22, inv_m66 = 1.0 / model.m11, 1.0 / model.m22, 1.0 / model.m66
    distance, cell, margin = scene.distance, scene.cell_m, scene.margin_m
    range2, cell2 = scene.range_m * scene.range_m, cell * cell
    # With the centre this far from all obstacles no boundary point can fail: the distance is 1-Lipschitz, up to half a
    # diagonal of each of the two cells compared.
    clear = scene.hull_m + margin + 1.5 * cell
    scales = scene.scales
    for k in range(n_rollouts):
        x, y, th, u, v, r = start[0], start[1], start[2], start[3], start[4], start[5]
        wx, wy = start[6], start[7]
        c, s = c0, s0
        path[k, 0, 0], path[k, 0, 1], path[k, 0, 2] = x, y, th
        ok = True
        sums, driven = costs[k], 0.0
        sums[:] = 0.0
        value, gx, gy = lookup(scene.value, scene.value_cell_m, x, y)
        pv, pw = previous[0], previous[1]
        for t in range(n_steps):
            dt = schedule.dt[t]
            if guide_speed[k] > 0.0:
                error = math.atan2(-gy, -gx) - th
                error -= 2.0 * math.pi * math.floor((error + math.pi) / (2.0 * math.pi))
                wanted = error / max(dt, 0.4)
                limit = scales.yaw_rate_rad_s
                controls[k, t, 1] = min(max(wanted + controls[k, t, 1], -limit), limit)
                forward = min(guide_speed[k], value / max(dt, 0.4)) * max(0.0, math.cos(error)) ** 2
                controls[k, t, 0] = min(max(forward + controls[k, t, 0], 0.0), scales.speed_m_s)
            cv, cw = controls[k, t, 0], controls[k, t, 1]
            change = ((cv - pv) / scales.speed_m_s) ** 2 + ((cw - pw) / scales.yaw_rate_rad_s) ** 2
            pv, pw = cv, cw
            h = dt / schedule.substeps[t]
            rate, yaw_rate, n_points = schedule.rate[t], schedule.yaw_rate[t], schedule.points[t]
            slow = schedule.trail_share[t]
            nearest = 1e9
            for _ in range(schedule.substeps[t]):
                # Drag and Coriolis forces, then the wrench of the velocity loop within the thrusters' limits.
                cor_u = model.m22 * v * r - (model.du + model.duu * abs(u)) * u
                cor_v = -model.m11 * u * r - (model.dv + model.dvv * abs(v)) * v
                cor_r = (model.m11 - model.m22) * u * v - (model.dr + model.drr * abs(r)) * r
                fx, fy, n = limit_wrench(
                    model.m11 * rate * (at_once * cv + c * wx + s * wy - u) - cor_u,
                    model.m22 * rate * (c * wy - s * wx - v) - cor_v,
                    model.m66 * yaw_rate * (cw - r) - cor_r,
                    model,
                )
                u1 = u + h * (fx + cor_u) * inv_m11
                v1 = v + h * (fy + cor_v) * inv_m22
                r1 = r + h * (n + cor_r) * inv_m66
                wx += slow * (schedule.trail * cv * c - wx)
                wy += slow * (schedule.trail * cv * s - wy)
                um, vm = 0.5 * (u + u1), 0.5 * (v + v1)
                half = 0.25 * h * (r + r1)
                cm, sm = turn(c, s, half)
                dx, dy = h * (cm * um - sm * vm), h * (sm * um + cm * vm)
                step2 = dx * dx + dy * dy
                if (x + dx - x0) ** 2 + (y + dy - y0) ** 2 < range2:
                    # Check the midpoint too: a coarse step may be longer than an obstacle is wide.
                    for part in range(0 if step2 > cell2 else 1, 2):
                        px, py = x + 0.5 * (1 + part) * dx, y + 0.5 * (1 + part) * dy
                        d = clearance_at(distance, cell, px, py)
                        nearest = min(nearest, d)
                        if d <= margin or (d < clear and not hull_is_free(scene, px, py, schedule.circle[t], n_points)):
                            ok = False
                x, y, th = x + dx, y + dy, th + 2.0 * half
                c, s = turn(cm, sm, half)
                u, v, r = u1, v1, r1
                driven += math.sqrt(step2)
                if not ok:
                    break
            path[k, t + 1, 0], path[k, t + 1, 1], path[k, t + 1, 2] = x, y, th
            if not ok:
                for rest in range(t + 1, n_steps):
                    path[k, rest + 1, 0], path[k, rest + 1, 1], path[k, rest + 1, 2] = x, y, th
                break
            value, gx, gy = lookup(scene.value, scene.value_cell_m, x, y)
            add_step(sums, Step(dt, u, c, s, value, gx, gy, nearest, change), scales)
        feasible[k] = ok
        finish(sums, horizon, n_steps, driven, value, v0, scales)
