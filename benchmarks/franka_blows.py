"""How hard a simulated Franka arm's hand hits what it is led into, with and without the slow approach.

    python benchmarks/franka_blows.py --runs 3 --out docs/results/franka-blows.md

The target runs ahead of the hand at the given speed, from 12 cm before the thing to 10 cm beyond its surface: down onto
a box, down onto the table, and sideways into a wall. The true force is that of the simulation's contacts; the measured
one has noise, lag and a filter. Objects' poses have 1 mm of noise and come 30 times a second.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from coral.contact.scene.observation import Array, HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.franka.cfg import FrankaCfg
from coral.contact.worlds.franka.double import Double, DoubleCfg, cfg_for_double
from coral.contact.worlds.franka.franky_arm import FrankyArm
from coral.contact.worlds.franka.stream import Phase
from coral.contact.worlds.franka.stream_process import StreamProcess
from coral.contact.worlds.franka.world import FrankaDoubleWorld
from coral.contact.worlds.robot_world import WorldError

STEP_S, AHEAD_M, BEYOND_M = 0.02, 0.12, 0.1
STIFFNESS_N_M = 600.0
PRESSING_S = 1.0
APPROACHING_S = 8.0
TOUCHED_N = 3.0
OFF = 100.0
"""A touching speed (m/s) that slows nothing down."""
DOWN, SIDEWAYS = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Blow:
    """What one blow did."""

    speed_m_s: float
    """Speed of the hand just before it touched."""
    true_n: float
    measured_n: float
    """Largest contact forces, true and as measured."""
    end: str
    """Why the arm was stopped; "" if it was not."""


def main() -> None:
    """Measure and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3, help="runs of each row")
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.1, 0.2, 0.35, 0.5], help="of the target, m/s")
    parser.add_argument("--speed", type=float, default=0.5, help="speed of the arm's clock")
    parser.add_argument("--things", nargs="+", default=["box", "table", "wall"])
    parser.add_argument("--touch-speed", type=float, nargs="+", default=[OFF, FrankaCfg().limits.touch_speed_m_s])
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows: list[tuple[str, float, float, list[Blow]]] = []
    for thing in args.things:
        for speed in args.speeds:
            for touch in args.touch_speed:
                blows = [strike(thing, speed, touch, seed, args.speed) for seed in range(args.runs)]
                rows.append((thing, speed, touch, blows))
                print(thing, speed, touch, *blows, sep="\n  ", flush=True)
                args.out.write_text(table(rows), encoding="utf-8")


def strike(thing: str, speed: float, touch_speed: float, seed: int, clock: float) -> Blow:
    """Lead the hand into something.

    Args:
        thing: "box", "table" or "wall".
        speed: Speed of the target, m/s.
        touch_speed: The limit on the speed at touch, m/s.
        seed: Seed of the trial.
        clock: Speed of the arm's clock.
    """
    name = "flip-wall" if thing == "wall" else "pick-box"
    trial = sample_trial(load_task(name), seed, name)
    cfg = cfg_for_double(FrankaCfg(poses_port=0))
    cfg = replace(cfg, limits=replace(cfg.limits, touch_speed_m_s=touch_speed))
    double = Double(trial, cfg, DoubleCfg(speed=clock))
    stream = StreamProcess(FrankyArm, double.address, cfg, trial)
    double.send_poses_to(cfg.poses_host, stream.poses_port)
    world = FrankaDoubleWorld(stream, cfg, STEP_S, (), double)
    try:
        return _strike(world, thing, speed)
    finally:
        world.close()


def _strike(world: FrankaDoubleWorld, thing: str, speed: float) -> Blow:
    tool = world.reset().tool
    start, direction = _start(world, thing, tool.position)
    for k in range(round(3.0 / STEP_S)):  # there, slowly, with closed fingers
        share = min(1.0, k * STEP_S / 2.0)
        world.step(HandTarget(tool.position + share * (start - tool.position), tool.quaternion, 0.0, STIFFNESS_N_M))
    world.truth()
    forces: list[float] = []
    before_m_s, touched, end = 0.0, 0.0, ""
    try:
        for k in range(round(APPROACHING_S / STEP_S)):
            way = min(speed * STEP_S * k, AHEAD_M + BEYOND_M)
            now = world.step(HandTarget(start + way * direction, tool.quaternion, 0.0, STIFFNESS_N_M))
            forces.append(world.double.peak_force_n())
            felt = float(np.linalg.norm(now.wrench[:3]))
            if forces[-1] < TOUCHED_N and not touched:
                before_m_s = float(now.tool.velocity @ direction)
            touched += STEP_S * (felt > TOUCHED_N)
            if touched > PRESSING_S:
                break
    except WorldError as error:
        end = str(error)
    report = world.stream.report()
    if report.phase is Phase.STOPPED:
        forces.append(world.double.peak_force_n())
    return Blow(before_m_s, max(forces), report.peak_force_n, end)


def _start(world: FrankaDoubleWorld, thing: str, tool_m: Array) -> tuple[Array, Array]:
    """Return where the hand starts, and its direction; the closed fingertips reach 8 mm beyond the tool."""
    if thing == "wall":
        return np.array([0.2 - 0.01 - AHEAD_M, 0.25, 0.12]), SIDEWAYS
    truth = world.truth()
    box = truth.objects["box"].position
    if thing == "box":
        return box + np.array([0.0, 0.0, box[2] + 0.008 + AHEAD_M]), DOWN
    aside = 0.15 if box[1] < 0.0 else -0.15
    return np.array([box[0], box[1] + aside, 0.008 + AHEAD_M]), DOWN


def table(rows: Sequence[tuple[str, float, float, list[Blow]]]) -> str:
    """Return the table as Markdown."""
    lines = [
        "# How hard the simulated arm's hand hits",
        "",
        "`python benchmarks/franka_blows.py`: franky-sim's arm with MuJoCo's contacts, led into things by a target",
        "that runs ahead. Median and worst of the runs. Nothing was measured on a real arm.",
        "",
        "| into | the target's speed | slow approach | runs | speed at touch | true force | as measured | stopped |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for thing, speed, touch, blows in rows:
        slow = "no" if touch >= OFF else f"{touch:g} m/s"
        at, true, measured = (
            np.array([getattr(blow, name) for blow in blows]) for name in ("speed_m_s", "true_n", "measured_n")
        )
        lines.append(
            f"| {thing} | {speed:g} m/s | {slow} | {len(blows)} | {np.median(at):.2f}, {at.max():.2f} m/s "
            f"| {np.median(true):.0f}, {true.max():.0f} N | {np.median(measured):.0f}, {measured.max():.0f} N "
            f"| {sum(bool(blow.end) for blow in blows)} |"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
