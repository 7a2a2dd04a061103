"""Time of the pilot's tick on a map of 100 m, by part: its median, 99th and 99.9th percentile and maximum.

Usage: nice -n -5 python benchmarks/tick.py [--edge 100] [--ticks 1500] [--repeats 3] [--perception painted]
           [--against OTHER/src] [--json]

A mission of the full system, with pictures and recording, in a generated reef of which one half has been mapped
before. Only what the control thread does is counted: see (the network that looks at a colour picture, with --perception
rgb), hear (the sonar, likewise), perceive (map update), track (clusters), question (snapshot,
preparation and check of questions), field (cost-to-go), plan (DDP-MPPI), record (frames and attempts), other. Two
times are printed: the thread's CPU time, which leaves out what else the machine does, and wall time without the waits
for answers, which includes it. With --against, the same mission is measured with the package in another source tree,
by turns with this one.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

PARTS = ("see", "hear", "perceive", "track", "question", "field", "plan", "record", "other", "tick")
WARM_TICKS = 30
"""Ticks that are left out: the first ones load compiled code."""


class Stopwatch:
    """Adds up the time that the control thread spends in each part itself, without the parts that it calls."""

    def __init__(self) -> None:
        self.ms: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(2))
        self._inner: list[np.ndarray] = []
        self._thread = threading.get_ident()

    def watch(self, owner: type, name: str, part: str) -> None:
        """Time the method `name` of a class as `part`; a class without it is left as it is."""
        call: Callable[..., Any] | None = getattr(owner, name, None)
        if call is None:
            return

        def timed(*args: Any, **named: Any) -> Any:
            if threading.get_ident() != self._thread:
                return call(*args, **named)
            begun = np.array([time.thread_time(), time.perf_counter()])
            self._inner.append(np.zeros(2))
            try:
                return call(*args, **named)
            finally:
                spent = 1e3 * (np.array([time.thread_time(), time.perf_counter()]) - begun)
                self.ms[part] += spent - self._inner.pop()
                if self._inner:
                    self._inner[-1] += spent

        setattr(owner, name, timed)

    def read(self) -> dict[str, np.ndarray]:
        """Return what has been added up since the last reading."""
        found, self.ms = self.ms, defaultdict(lambda: np.zeros(2))
        return found


def measure(edge_m: float, ticks: int, seed: int, perception: str) -> dict[str, Any]:
    """Run one mission. Return the times of its ticks by part (ms): of the CPU and of the wall."""
    from coral.advisor.log import AttemptRecorder
    from coral.advisor.registry import make_advisor
    from coral.reef.decide.heuristic import REEF_RULES
    from coral.reef.decide.tour_planner import TourPlanner
    from coral.reef.drive.controller import DdpMppi
    from coral.reef.eyes.reef_net import ReefNetEyes
    from coral.reef.generator.generate import GeneratorCfg, generate
    from coral.reef.map.belief import Belief
    from coral.reef.map.mapping import OccupancyMap
    from coral.reef.mission.mission import Mission
    from coral.reef.mission.mission_cfg import MissionCfg
    from coral.reef.mission.record import FrameRecorder, RecordCfg
    from coral.reef.pictures.questions import question_pictures
    from coral.reef.pilot.pilot import Pilot
    from coral.reef.vehicle.camera import Camera
    from coral.reef.world.geometry import Pose
    from coral.reef.world.scene import Scene

    watch = Stopwatch()
    for owner, name, part in (
        (ReefNetEyes, "perceive", "see"),
        (OccupancyMap, "hear", "hear"),
        (OccupancyMap, "integrate", "perceive"),
        (Belief, "update", "track"),
        (Belief, "snapshot", "question"),
        (TourPlanner, "ask", "question"),
        (TourPlanner, "verify", "question"),
        (TourPlanner, "onward", "question"),
        (Pilot, "_route", "field"),
        (DdpMppi, "plan", "plan"),
        (FrameRecorder, "offer", "record"),
        (AttemptRecorder, "__call__", "record"),
        (Pilot, "sense", "other"),
        (Pilot, "drive", "other"),
    ):
        watch.watch(owner, name, part)
    size = (edge_m, edge_m)
    world = generate(
        GeneratorCfg(
            topology="branching", size_m=size, clusters=0, obstacles=round(1.4 * edge_m), barriers=4, seed=seed
        )
    )
    cfg = MissionCfg(time_limit_s=0.1 * ticks, stop_when_covered=False, record=RecordCfg(report=False, video=False))
    if perception != "exact":
        simulator = replace(cfg.simulator, sonar=replace(cfg.simulator.sonar, enabled=True))
        cfg = replace(cfg, perception=perception, simulator=simulator, map=replace(cfg.map, obstacles="sonar"))
    with tempfile.TemporaryDirectory() as folder:
        advisor = make_advisor("heuristic", rules=REEF_RULES, rng=np.random.default_rng(0))
        mission = Mission(world, cfg, advisor, Path(folder) / "run", seed=0, draw=question_pictures)
        explore_half(mission.belief.map, Camera(Scene.from_world(world), cfg.simulator.camera), Pose)
        watch.read()
        rows: list[np.ndarray] = []
        waited = 0.0

        class Reader:
            def tick(self, mission: Mission) -> None:
                nonlocal waited
                spent = watch.read()
                idle = 1e3 * (mission.clock.waited_s - waited)
                waited = mission.clock.waited_s
                spent["other"][1] -= idle
                rows.append(np.array([*(spent[part] for part in PARTS[:-1]), sum(spent.values(), np.zeros(2))]))

            def stop_requested(self) -> str:
                return ""

        result = mission.run([Reader()])
    return {
        "ticks": len(rows) - WARM_TICKS,
        "questions": result["advisor_calls"],
        "inspected": result["inspected"],
        "memory_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
        "cpu": statistics(np.array(rows)[WARM_TICKS:, :, 0]),
        "wall": statistics(np.array(rows)[WARM_TICKS:, :, 1]),
    }


def explore_half(cells: Any, camera: Any, pose_type: Any) -> None:
    """Map the half of the reef with the larger x from poses 4 m apart."""
    width, height = cells.size_m
    for x in np.arange(width / 2, width - 1.0, 4.0):
        for y in np.arange(2.0, height - 1.0, 4.0):
            for theta in (0.0, np.pi):
                pose = pose_type(float(x), float(y), theta)
                for _ in range(cells.cfg.obstacle_hits):
                    cells.integrate(camera.render(pose), pose)


def statistics(ms: np.ndarray) -> dict[str, list[float]]:
    """Return median, 99th and 99.9th percentile and maximum of every part; ms has Shape=(ticks, parts)."""
    found = np.column_stack([*np.percentile(ms, [50, 99, 99.9], axis=0), ms.max(axis=0)])
    return {part: [round(value, 2) for value in row] for part, row in zip(PARTS, found.tolist(), strict=True)}


def median_of(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the medians of several runs, figure by figure."""
    if isinstance(runs[0], dict):
        return {key: median_of([run[key] for run in runs]) for key in runs[0]}
    return np.round(np.median(np.array(runs, float), axis=0), 3).tolist()


def one_run(args: argparse.Namespace, source: str) -> dict[str, Any]:
    """Measure in a process of its own with the package in `source`."""
    command = [
        sys.executable,
        __file__,
        "--one",
        f"--edge={args.edge}",
        f"--ticks={args.ticks}",
        f"--seed={args.seed}",
        f"--perception={args.perception}",
    ]
    environment = {**os.environ, "PYTHONPATH": source} if source else None
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edge", type=float, default=100.0, help="of the square map (m)")
    parser.add_argument("--ticks", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=5, help="of the generated reef")
    parser.add_argument("--perception", default="exact", help="rgb: a network sees, and a sonar hears obstacles")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--against", default="", help="another source folder, such as ../main/src")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.one:
        print(json.dumps(measure(args.edge, args.ticks, args.seed, args.perception)))
        return
    sources = {"this tree": "", **({args.against: args.against} if args.against else {})}
    runs: dict[str, list[dict[str, Any]]] = {name: [] for name in sources}
    for _ in range(args.repeats):
        for name, source in sources.items():
            runs[name].append(one_run(args, source))
    results = {name: median_of(found) for name, found in runs.items()}
    if args.json:
        print(json.dumps(results))
        return
    for name, found in results.items():
        print(
            f"{name}: {args.edge:g} m, {found['ticks']:.0f} ticks, {found['questions']:.0f} questions, "
            f"{100 * found['inspected']:.0f} % inspected, {found['memory_mb']:.0f} MB; medians of {args.repeats} runs\n"
        )
        for clock in ("cpu", "wall"):
            print(f"| {clock} time, ms | median | 99 % | 99.9 % | max |\n|---|---:|---:|---:|---:|")
            for part, row in found[clock].items():
                print(f"| {part} | {' | '.join(f'{value:.1f}' for value in row)} |")
            print()


if __name__ == "__main__":
    main()
