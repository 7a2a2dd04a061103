"""The pool trial on ten seeds, and a camera blinded for a minute amid obstacles: tables of docs/results/reef-pool.md.

python benchmarks/reef_sonar.py pool
python benchmarks/reef_sonar.py blind
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.fault_outcome import STANDS_M_S
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.resolution import resolve_mission, with_sonar
from coral.reef.world.generated import find_world
from coral.reef.world.world import shipped_worlds
from coral.runs import read_events, read_rows

QUIET = RecordCfg(pictures=False, frames=False, report=False)


def survey(name: str, seed: int, folder: Path, preset: str, **cfg: Any) -> dict[str, Any]:
    """Run one mission with the sonar, to the robot's own end or its time limit; add what the table needs."""
    wanted = with_sonar(MissionCfg(stop_when_covered=False, record=QUIET, **cfg))
    mission, world = resolve_mission(wanted, find_world(name), preset=preset)
    result = Mission(world, mission, RuleAdvisor(REEF_RULES), folder, seed=seed, preset=preset).run()
    rows = [*read_rows(folder / "trajectory.csv")]
    return {**result, "rows": rows, "events": [*read_events(folder / "events.jsonl")]}


def pools(folder: Path, seeds: int) -> None:
    """Print a row for each pool; the seed makes pattern, balls, start pose and noise."""
    print("| pool | heaps | covered | inspected | collisions | least clearance | driven | time | ended |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---|")
    for seed in range(seeds):
        found = survey(f"pool:{seed}", seed, folder / f"pool-{seed}", "pool", time_limit_s=300.0)
        clear = min(float(row["clearance"]) for row in found["rows"])
        print(
            f"| `pool:{seed}` | {found['clusters_total']} | {100 * found['coverage']:.0f} % "
            f"| {100 * found['inspected']:.1f} % | {found['collisions']} | {100 * clear:.0f} cm "
            f"| {found['distance_m']:.1f} m | {found['sim_time_s']:.0f} s | {found['end_reason']} |",
            flush=True,
        )


def blind(folder: Path) -> None:
    """Print a row for each shipped reef: the camera is blind from 15 to 75 s."""
    start, end = 15.0, 75.0
    print("| reef | driven blind | stood from | collisions | least clearance | questions asked blind | after it |")
    print("|---|---:|---:|---:|---:|---:|---|")
    for name in shipped_worlds():
        faults = (f"blind-camera@{start:g}:{end - start:g}",)
        found = survey(name, 0, folder / name, "clear", time_limit_s=end + 15.0, faults=faults)
        dark = [row for row in found["rows"] if start < float(row["t"]) <= end]
        speed = [(float(row["u"]) ** 2 + float(row["v"]) ** 2) ** 0.5 for row in dark]
        moving = [float(row["t"]) for row, fast in zip(dark, speed, strict=True) if fast >= STANDS_M_S]
        clear = min(float(row["clearance"]) for row in dark)
        asked = sum(e["event"] == "question" and start + 0.5 < e["t"] < end for e in found["events"])
        later = [row for row in found["rows"] if float(row["t"]) > end]
        went = sum((float(row["u"]) ** 2 + float(row["v"]) ** 2) ** 0.5 for row in later) * 0.1
        print(
            f"| `{name}` | {0.1 * sum(speed):.1f} m | {moving[-1] - start:.0f} s | {found['collisions']} "
            f"| {100 * clear:.0f} cm | {asked} | {went:.1f} m in 15 s |",
            flush=True,
        )


def main() -> None:
    """Run one of the two."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("which", nargs="?", choices=("pool", "blind"), default="pool")
    parser.add_argument("--seeds", type=int, default=10)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        pools(Path(folder), args.seeds) if args.which == "pool" else blind(Path(folder))


if __name__ == "__main__":
    main()
