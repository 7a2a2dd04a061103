"""What straight lanes 10 m apart inspect in the ten reefs, wherever they happen to lie: a table over their offsets.

    python benchmarks/blind_sweep.py [--along y]

The variant `blind-sweep` lays its lanes symmetrically in the survey area. A lane that happens to lie along a row of
clusters inspects much, so one offset says little; here the lanes are shifted in ten steps of 1 m.
"""

from __future__ import annotations

import argparse

import numpy as np

from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.tour import drive_lines, lanes
from coral.reef.simulation.imaging import ImagingMeter
from coral.reef.vehicle.tour_kernels import advance
from coral.reef.world.generated import find_world
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene

REEFS = ("l1", "l2", "s1", "s2", "k1", "k2", "e1", "e2", "o1", "o2")


def inspected(name: str, along: str, offset_m: float, cfg: MissionCfg) -> float:
    """Return the share of the oysters' area that the lanes inspect in clear water, mean over clusters (%)."""
    world = find_world(name)
    start = Pose(world.start.x, world.start.y, world.start.theta)
    if along == "x":
        points = lanes(world.size_m, cfg.lane_m, start, offset_m)
    else:
        points = lanes(world.size_m[::-1], cfg.lane_m, Pose(start.y, start.x, 0.0), offset_m)[:, ::-1].copy()
    poses = [tuple(start)]
    for v, omega in drive_lines(points, start, cfg.simulator.vehicle, cfg.control_period_s):
        poses.append(advance(*poses[-1], v, omega, cfg.control_period_s))
    meter = ImagingMeter(Scene.from_world(world))
    levels, counts = np.zeros(len(meter.points), np.uint8), np.zeros((3, len(meter.names)), np.int64)
    meter.look_along(np.array(poses), levels, counts)
    return 100.0 * float((counts[2] / meter.size).mean())


def row(name: str, values: list[float]) -> str:
    """Format one row of the table, with the mean of its values."""
    return f"| {name} | " + " | ".join(f"{value:.0f}" for value in [*values, np.mean(values)]) + " |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reefs", nargs="+", default=REEFS)
    parser.add_argument("--along", choices=("x", "y"), default="x", help="direction of the lanes")
    words, cfg = parser.parse_args(), MissionCfg()
    offsets = np.arange(-5.0, 5.0)
    print("| offset (m) | " + " | ".join(f"{offset:+.0f}" for offset in offsets) + " | mean |")
    print("|---|" + "---:|" * (len(offsets) + 1))
    rows = []
    for name in words.reefs:
        rows.append([inspected(name, words.along, float(offset), cfg) for offset in offsets])
        print(row(name, rows[-1]), flush=True)
    print(row("mean", np.mean(rows, axis=0).tolist()))


if __name__ == "__main__":
    main()
