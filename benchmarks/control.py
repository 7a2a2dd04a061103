"""CPU time of one control step against the same work in plain NumPy, single-threaded.

Usage: OPENBLAS_NUM_THREADS=1 python benchmarks/control.py [--steps 200]

The plain NumPy planner propagates all rollouts at once, array by array, with the same model, checks and cost terms; it
is what a vectorised Python implementation costs. Both solve the same 12 x 12 m map, and a full `plan` call is timed:
sampling, rollouts, weights, and the check of the mean.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.drive.controller import DdpMppi, MppiCfg
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.dynamics import Thrusters, planar
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState

CELL_M = 0.05
CASES = {
    "400 x 10 DDP (default)": MppiCfg(),
    "400 x 10 uniform, same horizon": MppiCfg(uniform=True),
    "400 x 60 uniform, 6 s": MppiCfg(uniform=True, n_steps=60, horizon_s=6.0),
    "2000 x 56 uniform, 2.8 s": MppiCfg(uniform=True, n_rollouts=2000, n_steps=56, horizon_s=2.8),
}
Array = NDArray[np.float64]


class NumpyMppi(DdpMppi):
    """The same planner with its rollouts as NumPy array operations over all rollouts."""

    def _evaluate(self, start: Array, controls: Array, guide: Array, scene) -> Array:
        m, table = self._model, self.schedule
        mass = np.array([m.m11, m.m22, m.m66])
        linear, quadratic = np.array([m.du, m.dv, m.dr]), np.array([m.duu, m.dvv, m.drr])
        k = len(controls)
        x, y, th = (np.full(k, start[i]) for i in range(3))
        nu = np.tile(start[3:], (k, 1))
        ok = np.ones(k, bool)
        goal, near, speed, heading, driven = (np.zeros(k) for _ in range(5))
        value, gx, gy = self._look(scene, x, y)
        v0 = value[0]
        self._path[:, 0] = start[:3]
        last = np.tile(self._executed, (k, 1))
        smooth = np.zeros(k)
        limits = np.array([scene.speed_m_s, scene.yaw_rate_rad_s])
        for t in range(controls.shape[1]):
            g = guide > 0.0
            error = np.arctan2(-gy[g], -gx[g]) - th[g]
            error -= 2 * np.pi * np.floor((error + np.pi) / (2 * np.pi))
            ahead = np.minimum(guide[g], value[g] / max(table.dt[t], 0.4)) * np.maximum(0.0, np.cos(error)) ** 2
            controls[g, t, 0] = np.clip(controls[g, t, 0] + ahead, 0.0, limits[0])
            controls[g, t, 1] = np.clip(controls[g, t, 1] + error / max(table.dt[t], 0.4), -limits[1], limits[1])
            command = controls[:, t]
            smooth += (((command - last) / limits) ** 2).sum(axis=1)
            last = command
            target = np.stack([command[:, 0], np.zeros(k), command[:, 1]], axis=1)
            h = table.dt[t] / table.substeps[t]
            rate = np.array([table.rate[t], table.rate[t], table.yaw_rate[t]])
            nearest = np.full(k, 1e9)
            circle = table.circle[t, : table.points[t]]
            for _ in range(table.substeps[t]):
                u, v, r = nu.T
                coriolis = np.stack([-m.m22 * v * r, m.m11 * u * r, (m.m22 - m.m11) * u * v], axis=1)
                drag = (linear + quadratic * np.abs(nu)) * nu + coriolis
                asked = mass * rate * (target - nu) + drag
                n = np.clip(asked[:, 2] / m.moment_arm, -m.thrust_max, m.thrust_max)
                left = m.thrust_max - np.abs(n)
                fy = np.clip(asked[:, 1] / m.force_arm, -left, left)
                left = left - np.abs(fy)
                fx = np.clip(asked[:, 0] / m.force_arm, -left, left)
                made = np.stack([fx * m.force_arm, fy * m.force_arm, n * m.moment_arm], axis=1)
                new = nu + h * (made - drag) / mass
                mean = 0.5 * (nu + new)
                mid = th + 0.5 * h * mean[:, 2]
                c, s = np.cos(mid), np.sin(mid)
                dx, dy = h * (c * mean[:, 0] - s * mean[:, 1]), h * (s * mean[:, 0] + c * mean[:, 1])
                for part in (0.5, 1.0):
                    px, py = x + part * dx, y + part * dy
                    nearest = np.minimum(nearest, self._clear(scene, px, py))
                    hull = self._clear(
                        scene,
                        px[:, None] + scene.hull_m * circle[None, :, 0],
                        py[:, None] + scene.hull_m * circle[None, :, 1],
                    )
                    ok &= hull.min(axis=1) > scene.margin_m
                x, y, th, nu = x + dx, y + dy, th + h * mean[:, 2], new
                driven += np.hypot(dx, dy)
            self._path[:, t + 1] = np.stack([x, y, th], axis=1)
            value, gx, gy = self._look(scene, x, y)
            dt = table.dt[t]
            goal += value * dt
            near += np.maximum(0.0, 1.0 - (nearest - scene.body_m) / scene.soft_m) ** 2 * dt
            far = np.minimum(1.0, value) * dt
            speed += np.maximum(0.0, 1.0 - np.maximum(nu[:, 0], 0.0) / limits[0]) * far
            size = np.maximum(np.hypot(gx, gy), 1e-9)
            heading += 0.5 * (1.0 + (gx * np.cos(th) + gy * np.sin(th)) / size) * far
        self._feasible[:] = ok
        horizon = table.dt.sum()
        self._costs[:] = np.stack(
            [
                (0.5 * (value + goal / horizon) - v0) / scene.reach_m,
                near / horizon,
                speed / horizon,
                (driven + value - v0) / scene.reach_m,
                heading / horizon,
                smooth / controls.shape[1],
            ],
            axis=1,
        )
        return np.where(ok, self._costs @ self._weights, np.inf)

    @staticmethod
    def _clear(scene, x: Array, y: Array) -> Array:
        h, w = scene.distance.shape
        edge = np.minimum(np.minimum(x, w * scene.cell_m - x), np.minimum(y, h * scene.cell_m - y))
        i = np.clip((x / scene.cell_m).astype(int), 0, w - 1)
        j = np.clip((y / scene.cell_m).astype(int), 0, h - 1)
        return np.minimum(edge, scene.distance[j, i])

    @staticmethod
    def _look(scene, x: Array, y: Array) -> tuple[Array, Array, Array]:
        h, w = scene.value.shape
        cell = scene.value_cell_m
        fx, fy = np.clip(x / cell - 0.5, 0.0, w - 1.001), np.clip(y / cell - 0.5, 0.0, h - 1.001)
        i, j = fx.astype(int), fy.astype(int)
        a, b = fx - i, fy - j
        v00, v01, v10, v11 = (scene.value[j + dj, i + di] for dj in (0, 1) for di in (0, 1))
        low, high = v00 + a * (v01 - v00), v10 + a * (v11 - v10)
        return low + b * (high - low), ((1 - b) * (v01 - v00) + b * (v11 - v10)) / cell, (high - low) / cell


def field_of_discs() -> NDArray[np.float32]:
    """Distance map of a 12 x 12 m map with some discs."""
    rng = np.random.default_rng(4)
    obstacle = np.zeros((240, 240), np.uint8)
    for _ in range(14):
        centre = (int(rng.integers(40, 200)), int(rng.integers(40, 200)))
        cv2.circle(obstacle, centre, int(rng.integers(4, 12)), 1, -1)
    obstacle[10:50, 10:50] = 0
    return cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL_M)


def drive(controller: DdpMppi, steps: int) -> tuple[Array, list[tuple[float, float]]]:
    """Times (ms) of every control step of a drive through the discs, and the commands."""
    distance = field_of_discs()
    cost_field = CostField.compute(distance, (11.0, 11.0), start=(1.5, 1.5))
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(1.5, 1.5, 0.5))
    times, commands = [], []
    for _ in range(steps):
        begun = time.process_time()
        plan = controller.plan(vehicle.state, cost_field, distance)
        times.append(1e3 * (time.process_time() - begun))
        commands.append(plan.command)
        vehicle.step(plan.command)
        if np.hypot(vehicle.state.x - 11.0, vehicle.state.y - 11.0) < 1.0:
            vehicle.reset(VehicleState(1.5, 1.5, 0.5))
            controller.reset()
    return np.array(times[5:]), commands


def median_ms(call: Callable[[], object], n: int = 50) -> float:
    """Median time of a call (ms)."""
    times = []
    for _ in range(n):
        begun = time.process_time()
        call()
        times.append(time.process_time() - begun)
    return 1e3 * float(np.median(times))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200)
    args = parser.parse_args()
    planar(Thrusters())
    print("| control step | median ms | p99 ms | plain NumPy ms | ratio |")
    print("|---|---:|---:|---:|---:|")
    for name, cfg in CASES.items():
        drive(DdpMppi(cfg, rng=np.random.default_rng(0)), 10)
        ours, commands = drive(DdpMppi(cfg, rng=np.random.default_rng(0)), args.steps)
        plain, other = drive(NumpyMppi(cfg, rng=np.random.default_rng(0)), 12)
        same = np.abs(np.array(commands[:12]) - np.array(other)).max() < 0.01
        mark = "" if same else " (commands differ!)"
        print(
            f"| {name} | {np.median(ours):.2f} | {np.percentile(ours, 99):.2f} | {np.median(plain):.1f} | "
            f"{np.median(plain) / np.median(ours):.0f}x{mark} |"
        )
    rng = np.random.default_rng(0)
    obstacle = np.zeros((600, 600), np.uint8)
    for _ in range(60):
        cv2.circle(obstacle, tuple(int(a) for a in rng.integers(0, 600, 2)), int(rng.integers(5, 20)), 1, -1)
    distance = cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL_M)
    print(f"\ncost-to-go, 30 x 30 m at 0.1 m: {median_ms(lambda: CostField.compute(distance, (25.0, 25.0))):.2f} ms")


if __name__ == "__main__":
    main()
