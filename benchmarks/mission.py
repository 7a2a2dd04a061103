"""Time of a whole control tick and of its parts, and how it grows with the map, the oysters and the robots.

Usage: python benchmarks/mission.py [--ticks 600] [--repeats 3] [--json]

A mission of the full system in a reef of the given size, without pictures or a report; the heuristic advisor answers
at once, so that the vehicle never waits. Parts: sense (picture), check (the guard of the sensors), map (map update,
centroids), decide (trigger, advisor, checks, cost-to-go, path monitor), control (DDP-MPPI), act (vehicle, contacts,
coverage, log). Parts are means over the ticks, since some work is only done now and then, and add up to the mean
tick. Each repeat is the same mission, with the same seed; the median of the repeats is printed. All times are CPU
time, which leaves out what else the machine does.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mapping import reef

from coral.advisor.registry import make_advisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import ReefWorld

CASES = {
    "map": [(10.0, 500), (20.0, 500), (40.0, 500), (80.0, 500)],
    "oysters": [(30.0, 100), (30.0, 400), (30.0, 1600), (30.0, 6400)],
    "robots": [(20.0, 500, robots) for robots in (1, 2, 3, 4)],
}
"""(edge of the square map in metres, oysters, robots where not one) of each case."""
PARTS = ("sense", "check", "map", "decide", "control", "act")
COMPILE_TICKS = 5


class Stopwatch:
    """Sums the time of wrapped calls (ms) until it is read."""

    def __init__(self) -> None:
        self.ms: dict[str, float] = {}

    def watch(self, name: str, call: Callable) -> Callable:
        """The same call, timed."""

        def timed(*args, **named):
            begun = time.process_time()
            try:
                return call(*args, **named)
            finally:
                self.ms[name] = self.ms.get(name, 0.0) + 1e3 * (time.process_time() - begun)

        return timed

    def read(self) -> dict[str, float]:
        """What has come together since the last reading."""
        found, self.ms = self.ms, {}
        return found


def run(world: ReefWorld, ticks: int, folder: Path, robots: int) -> list[dict[str, float]]:
    """Times of every tick of a mission (ms)."""
    cfg = MissionCfg(
        time_limit_s=0.1 * ticks,
        stop_when_covered=False,
        latency="fixed:0",
        robots=robots,
        record=RecordCfg(pictures=False, frames=False, report=False, video=False),
    )
    advisor = make_advisor("heuristic", rules=REEF_RULES, rng=np.random.default_rng(0))
    mission, watch = Mission(world, cfg, advisor, folder, seed=0), Stopwatch()
    for robot, vehicle in zip(mission.robots, mission.vehicles, strict=True):
        vehicle.simulator.sense = watch.watch("sense", vehicle.simulator.sense)
        robot.belief.update = watch.watch("map", robot.belief.update)
        robot.driver.plan = watch.watch("control", robot.driver.plan)
        robot.pilot.sense = watch.watch("check", robot.pilot.sense)
        robot.pilot.drive = watch.watch("pilot", robot.pilot.drive)
    mission.advance = watch.watch("tick", mission.advance)
    rows: list[dict[str, float]] = []

    class Reader:
        def tick(self, mission: Mission) -> None:
            spent = watch.read()
            rows.append(
                {
                    "tick": spent["tick"],
                    "sense": spent["sense"],
                    "check": spent["check"],
                    "map": spent["map"],
                    "decide": spent["pilot"] - spent["map"] - spent.get("control", 0.0),
                    "control": spent.get("control", 0.0),
                    "act": spent["tick"] - spent["sense"] - spent["check"] - spent["pilot"],
                }
            )

        def stop_requested(self) -> str:
            return ""

    mission.run([Reader()])
    return rows[COMPILE_TICKS:]


def measure(edge_m: float, oysters: int, ticks: int, repeats: int, robots: int = 1) -> dict[str, float]:
    """One line of a table."""
    world = reef(edge_m, oysters, np.random.default_rng(3))
    repeated = []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            rows = run(world, ticks, Path(folder) / "run", robots)
        ticks_ms = np.array([row["tick"] for row in rows])
        repeated.append(
            [
                *(np.mean([row[part] for row in rows]) for part in PARTS),
                ticks_ms.mean(),
                np.median(ticks_ms),
                np.percentile(ticks_ms, 99),
            ]
        )
    *parts, mean, median, p99 = np.median(np.array(repeated), axis=0).tolist()
    return {
        "edge_m": edge_m,
        "oysters": sum(len(c.oysters) for c in world.clusters),
        "robots": robots,
        "ticks": len(rows),
        **{f"{part}_ms": value for part, value in zip(PARTS, parts, strict=True)},
        "tick_ms": mean,
        "tick_median_ms": median,
        "tick_p99_ms": p99,
        "realtime": 100.0 / mean,
    }


COLUMNS = {
    "edge_m": "map, m",
    "oysters": "oysters",
    "robots": "robots",
    **{f"{part}_ms": part for part in PARTS},
    "tick_ms": "whole tick",
    "tick_median_ms": "its median",
    "tick_p99_ms": "99th percentile",
    "realtime": "times real time",
}


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=600, help="of each mission, 0.1 s each")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--largest", type=float, default=math.inf, help="leave out larger maps (m)")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    measure(10.0, 40, COMPILE_TICKS + 5, 1)  # compiles
    rows = {
        name: [measure(*case[:2], args.ticks, args.repeats, *case[2:]) for case in cases if case[0] <= args.largest]
        for name, cases in CASES.items()
    }
    if args.json:
        print(json.dumps(rows))
        return
    for name, lines in rows.items():
        print(f"Growth with the {name}; ms for each tick\n\n| {' | '.join(COLUMNS.values())} |")
        print(f"|{'---:|' * len(COLUMNS)}")
        for line in lines:
            print(
                "| "
                + " | ".join(f"{line[key]:.2f}" if key.endswith("_ms") else f"{line[key]:.0f}" for key in COLUMNS)
                + " |"
            )
        print()


if __name__ == "__main__":
    main()
