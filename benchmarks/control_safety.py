"""Safety of the controller in clutter it discovers as it goes: collisions, failures, speed, time to goal.

Usage: python benchmarks/control_safety.py [--seeds 30] [--seconds 120] [--variant ddp] [--straight] [--set key=value]
       [--png DIR]

A 20 x 20 m field of discs and boxes, passages 1.0 to 1.4 m wide. The robot knows an obstacle's surface once a ray of
its 120 degree camera has hit it within 4 m (the paper's sensing range). Collisions are counted against the exact
shapes at every integration step of the vehicle. With --straight the controller gets the straight distance to the goal
instead of the cost-to-go around what it knows. A goal is given up after 20 s on one spot, and the next one is drawn.
"""

from __future__ import annotations

import argparse
import ast
import dataclasses
import math
import time
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.drive.controller import DdpMppi, MppiCfg
from coral.reef.drive.pd import PdController
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.water import Water
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState

SIZE_M, CELL_M, HULL_M = 20.0, 0.05, 0.3
PATIENCE = 200
"""Ticks on one spot after which a goal is given up: 20 s, as in the paper's trigger."""
VARIANTS = {
    "ddp": {},
    "uniform": {"uniform": True},
    "uniform-1s": {"uniform": True, "horizon_s": 1.0},
    "pd": None,
}


@njit(cache=True)
def true_clearance(shapes: NDArray[np.float64], x: float, y: float) -> float:
    """Signed distance (m) to the nearest shape; rows (x, y, half x, half y, yaw), half y = 0 for a disc."""
    best = 1e9
    for k in range(shapes.shape[0]):
        dx, dy = x - shapes[k, 0], y - shapes[k, 1]
        if shapes[k, 3] == 0.0:
            d = math.hypot(dx, dy) - shapes[k, 2]
        else:
            c, s = math.cos(shapes[k, 4]), math.sin(shapes[k, 4])
            qx, qy = abs(c * dx + s * dy) - shapes[k, 2], abs(-s * dx + c * dy) - shapes[k, 3]
            d = math.hypot(max(qx, 0.0), max(qy, 0.0)) + min(max(qx, qy), 0.0)
        best = min(best, d)
    return best


@njit(cache=True)
def see(shapes: NDArray[np.float64], known: NDArray[np.uint8], x: float, y: float, theta: float, reach: float) -> int:
    """Mark the cells where 240 rays over 120 degrees first meet a shape (sphere tracing); returns new cells."""
    new = 0
    for k in range(240):
        a = theta + math.radians(-60.0 + 120.0 * (k + 0.5) / 240)
        c, s = math.cos(a), math.sin(a)
        along = 0.0
        while along < reach:
            px, py = x + along * c, y + along * s
            d = true_clearance(shapes, px, py)
            if d < 0.005:
                i, j = int((px + 0.01 * c) / CELL_M), int((py + 0.01 * s) / CELL_M)
                if 0 <= j < known.shape[0] and 0 <= i < known.shape[1] and not known[j, i]:
                    known[j, i] = 1
                    new += 1
                break
            along += max(d, 0.005)
    return new


def clutter(rng: np.random.Generator) -> NDArray[np.float64]:
    """Shapes packed until no more fit; each keeps its own gap of 1.0 to 1.4 m to the others."""
    shapes = np.zeros((0, 5))
    for _ in range(6000):
        x, y = rng.uniform(0.5, SIZE_M - 0.5, 2)
        gap = rng.uniform(1.0, 1.4)
        if rng.random() < 0.5:
            new = np.array([x, y, rng.uniform(0.2, 0.7), 0.0, 0.0])
            rim = np.stack([np.cos(t := np.linspace(0, 2 * np.pi, 40)), np.sin(t)], 1) * new[2] + (x, y)
        else:
            new = np.array([x, y, rng.uniform(0.2, 1.2), rng.uniform(0.2, 0.5), rng.uniform(0, np.pi)])
            e = np.linspace(-1, 1, 25)
            box = np.concatenate([np.stack([e, e * 0 + s], 1) for s in (-1, 1)])
            box = np.concatenate([box, box[:, ::-1]]) * new[2:4]
            c, s = np.cos(new[4]), np.sin(new[4])
            rim = box @ np.array([[c, s], [-s, c]]) + (x, y)
        if len(shapes) and min(true_clearance(shapes, *p) for p in rim) < gap:
            continue
        shapes = np.vstack([shapes, new])
    return shapes


@dataclass
class Result:
    """One run."""

    collisions: int = 0
    failures: int = 0
    reasons: dict[str, int] = field(default_factory=dict)
    stuck_s: float = 0.0
    goals: int = 0
    unreachable: int = 0
    given_up: int = 0
    distance_m: float = 0.0
    ideal_m: float = 0.0
    seconds: float = 0.0
    clearance_m: float = 9.0
    jerk: float = 0.0
    ms: list[float] = field(default_factory=list)
    log: list[tuple[float, ...]] = field(default_factory=list)


def free_point(rng: np.random.Generator, shapes: NDArray[np.float64], clear: float) -> tuple[float, float]:
    """A point at least `clear` metres from every shape."""
    while True:
        x, y = rng.uniform(1.0, SIZE_M - 1.0, 2)
        if true_clearance(shapes, x, y) > clear:
            return float(x), float(y)


def mission(
    seed: int, seconds: float, overrides: dict[str, object] | None, reach_m: float, *, straight: bool = False
) -> Result:
    """Drive from random goal to random goal; overrides None is the PD controller."""
    rng = np.random.default_rng(seed)
    shapes = clutter(rng)
    x, y = free_point(rng, shapes, 0.5)
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(x, y, rng.uniform(-np.pi, np.pi)))
    angle = rng.uniform(-np.pi, np.pi)
    current = (0.1 * math.cos(angle), 0.1 * math.sin(angle))
    driver = (
        PdController()
        if overrides is None
        else DdpMppi(configure(overrides), vehicle.cfg, np.random.default_rng(seed + 10_000))
    )
    known = np.zeros((round(SIZE_M / CELL_M),) * 2, np.uint8)
    distance = np.full(known.shape, np.inf, np.float32)
    goal = free_point(rng, shapes, 0.45)
    cost_field, out, touching, last = None, Result(), False, np.zeros(2)
    recent: list[tuple[float, float]] = []
    for tick in range(round(seconds / 0.1)):
        s = vehicle.state
        if see(shapes, known, s.x, s.y, s.theta, reach_m) or tick == 0:
            if known.any():
                distance = cv2.distanceTransform(1 - known, cv2.DIST_L2, 5) * np.float32(CELL_M)
            fresh = True
        else:
            fresh = False
        if straight and cost_field is None:
            cost_field = CostField.straight(known.shape, goal, cell_m=CELL_M)
        elif cost_field is None or (fresh and tick % 3 == 0 and not straight):
            water = Water.over(distance, CELL_M, CostFieldCfg())
            cost_field = CostField.over(water.slowness, goal, start=(s.x, s.y), cell_m=water.cell_m)
        t0 = time.perf_counter()
        plan = driver.plan(s, cost_field, distance, cell_m=CELL_M)
        out.ms.append(1e3 * (time.perf_counter() - t0))
        if not plan.ok:
            out.failures += 1
            out.reasons[plan.failure] = out.reasons.get(plan.failure, 0) + 1
        trace = vehicle.step(plan.command, current=current, contact=lambda x, y: true_clearance(shapes, x, y))
        for px, py in trace:
            gap = true_clearance(shapes, px, py) - HULL_M
            out.clearance_m = min(out.clearance_m, gap)
            out.collisions += gap < 0.0 and not touching
            touching = gap < 0.0 or (touching and gap < 0.05)
        e = vehicle.state
        out.distance_m += math.hypot(e.x - s.x, e.y - s.y)
        command = np.array(plan.command)
        out.jerk += float(np.abs(command - last).sum())
        last = command
        recent = [*recent[-PATIENCE + 1 :], (e.x, e.y)]
        half = np.array(recent[-PATIENCE // 2 :])
        if len(half) == PATIENCE // 2 and np.ptp(half, axis=0).max() < 0.2:
            out.stuck_s += 0.1
        given_up = len(recent) == PATIENCE and np.ptp(np.array(recent), axis=0).max() < 0.2
        out.log.append((e.x, e.y, e.theta, e.u, *plan.command, float(plan.ok), *goal))
        if math.hypot(goal[0] - e.x, goal[1] - e.y) < 0.5 or cost_field.failure or given_up:
            out.unreachable += bool(cost_field.failure)
            out.given_up += given_up
            out.goals += not cost_field.failure and not given_up
            goal = free_point(rng, shapes, 0.45)
            cost_field, recent = None, []
    out.seconds = seconds
    out.jerk /= len(out.log)
    return out


def configure(overrides: dict[str, object]) -> MppiCfg:
    """MppiCfg with some fields replaced; costs.NAME reaches into the weights."""
    cfg = MppiCfg()
    costs = {k[6:]: v for k, v in overrides.items() if k.startswith("costs.")}
    own = {k: v for k, v in overrides.items() if not k.startswith("costs.")}
    return dataclasses.replace(cfg, costs=dataclasses.replace(cfg.costs, **costs), **own)


def draw(path: Path, seed: int, result: Result) -> None:
    """Trajectory coloured by speed, and the commands over time."""
    import matplotlib.pyplot as plt

    shapes = clutter(np.random.default_rng(seed))
    fig, axes = plt.subplots(1, 2, figsize=(17, 9), width_ratios=(1.2, 1))
    for x, y, a, b, yaw in shapes:
        if b == 0.0:
            axes[0].add_patch(plt.Circle((x, y), a, color="k"))
        else:
            axes[0].add_patch(
                plt.Rectangle((x - a, y - b), 2 * a, 2 * b, angle=math.degrees(yaw), rotation_point="center", color="k")
            )
    log = np.array(result.log)
    axes[0].scatter(log[:, 0], log[:, 1], c=log[:, 3], s=4, cmap="turbo", vmin=0, vmax=0.6)
    axes[0].plot(log[:, 7], log[:, 8], "r*")
    axes[0].plot(log[0, 0], log[0, 1], "go")
    bad = log[log[:, 6] < 1]
    axes[0].plot(bad[:, 0], bad[:, 1], "mx")
    axes[0].set(xlim=(0, SIZE_M), ylim=(0, SIZE_M), aspect="equal")
    t = 0.1 * np.arange(len(log))
    axes[1].plot(t, log[:, 4], label="v_cmd", lw=0.8)
    axes[1].plot(t, log[:, 5] - 1.0, label="omega_cmd - 1", lw=0.8)
    axes[1].legend()
    fig.tight_layout()
    fig.savefig(path / f"seed{seed}.png", dpi=60)
    plt.close(fig)


def main() -> None:
    """Run the seeds and print one line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--variant", choices=VARIANTS, default="ddp")
    parser.add_argument("--straight", action="store_true")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE")
    parser.add_argument("--reach", type=float, default=4.0)
    parser.add_argument("--png", type=Path)
    args = parser.parse_args()
    overrides = VARIANTS[args.variant]
    if overrides is not None:
        overrides = overrides | {k: ast.literal_eval(v) for k, v in (s.split("=") for s in args.set)}
    total: list[Result] = []
    for seed in range(args.first, args.first + args.seeds):
        r = mission(seed, args.seconds, overrides, args.reach, straight=args.straight)
        total.append(r)
        if args.png:
            draw(args.png, seed, r)
        if r.collisions or r.failures or r.stuck_s:
            print(f"seed {seed}: collisions {r.collisions} {r.reasons} stuck {r.stuck_s:.1f} s")
    ms = np.concatenate([r.ms[5:] for r in total])
    n = len(total)
    goals, name = [r.goals for r in total], f"{args.variant}{' straight' if args.straight else ''} {args.set}"
    print(
        f"{name} | collisions {sum(r.collisions for r in total)} in {sum(r.collisions > 0 for r in total)}/{n} runs | "
        f"failed ticks {sum(r.failures for r in total)} | "
        f"stuck {sum(r.stuck_s for r in total):.0f} s in {sum(r.stuck_s > 0 for r in total)} | "
        f"speed {sum(r.distance_m for r in total) / sum(r.seconds for r in total):.3f} m/s | "
        f"goals {sum(goals)} {goals} ({sum(r.seconds for r in total) / max(1, sum(goals)):.1f} s each), "
        f"given up {sum(r.given_up for r in total)} | min clearance {min(r.clearance_m for r in total):.3f} m | "
        f"command change {np.mean([r.jerk for r in total]):.4f} | "
        f"{np.median(ms):.2f} ms median {np.percentile(ms, 99):.2f} p99"
    )


if __name__ == "__main__":
    main()
