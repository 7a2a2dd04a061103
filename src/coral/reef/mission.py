"""One mission, end to end: a world, a configuration and an advisor in, a run folder out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.advisor.latency import LatencyCfg, latency_for, parse_latency
from coral.advisor.log import AttemptRecorder
from coral.advisor.prompt import render as render_prompt
from coral.advisor.question import Advisor, Picture
from coral.advisor.rules import RuleAdvisor
from coral.config import Positive, TimeStep, to_mapping
from coral.reef.baselines import baseline_rules
from coral.reef.belief import Belief, BeliefCfg
from coral.reef.controller import DdpMppi, MppiCfg
from coral.reef.heuristic import REEF_RULES
from coral.reef.mapping import MapCfg, OccupancyMap
from coral.reef.metrics import compute_metrics
from coral.reef.pd import PdController
from coral.reef.pilot import LocalPlanner, Pilot, PilotCfg
from coral.reef.planner import HighLevelPlanner, PlannerCfg
from coral.reef.record import COLUMNS, FrameRecorder, RecordCfg
from coral.reef.simulator import ReefSimulator, Sensed, SimulatorCfg
from coral.reef.world import ReefWorld, save_world
from coral.runs import RunWriter, provenance

PAPER_LATENCY = "fixed:10"
"""Median latency of a call in the paper's CORAL experiments (IV-E)."""


@dataclass(frozen=True, kw_only=True)
class MissionCfg:
    """Everything that defines a mission besides the world, the advisor and the seed."""

    time_limit_s: Positive = 600.0
    control_period_s: TimeStep = 0.1
    """10 Hz (paper IV-F)."""
    latency: str = "auto"
    """Advisor's reply time in simulated seconds: fixed:S, lognormal:MEDIAN:SIGMA, measured. auto: as recorded for a
    recording, measured for models and people, and for rules fixed:10, the paper's median for CORAL (IV-E)."""
    stop_when_covered: bool = True
    """End once every true cluster is covered. This is the experimenter's stop, as in the paper's coverage-time
    metric; the robot does not know it and decides nothing by it. False: the robot goes on until nothing is left."""
    driver: Literal["ddp-mppi", "pd"] = "ddp-mppi"
    """The low-level planner."""
    decider: Literal["advisor", "nearest", "frontier", "lawnmower"] = "advisor"
    """Who answers the questions: the advisor, or the rules of a baseline in its place."""
    simulator: SimulatorCfg = field(default_factory=SimulatorCfg)
    map: MapCfg = field(default_factory=MapCfg)
    belief: BeliefCfg = field(default_factory=BeliefCfg)
    planner: PlannerCfg = field(default_factory=PlannerCfg)
    pilot: PilotCfg = field(default_factory=PilotCfg)
    controller: MppiCfg = field(default_factory=MppiCfg)
    record: RecordCfg = field(default_factory=RecordCfg)


class Observer(Protocol):
    """Anything that watches a mission: a progress bar, a live view."""

    def tick(self, mission: Mission) -> None:
        """Called after every control tick."""
        ...

    def stop_requested(self) -> str:
        """Reason to stop now, or ""."""
        ...


class Mission:
    """Couples the simulated reef with the pilot and writes what happens."""

    def __init__(self, world: ReefWorld, cfg: MissionCfg, advisor: Advisor, folder: Path, *, seed: int = 0,
                 variant: str = "full", draw: Callable[[Belief], tuple[Picture, ...]] | None = None) -> None:
        sim_rng, control_rng, clock_rng = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3))
        if cfg.decider != "advisor":
            advisor = RuleAdvisor(baseline_rules(cfg.decider), name=cfg.decider)
        self.world, self.cfg, self.seed, self.variant, self.advisor = world, cfg, seed, variant, advisor
        self.step, self.t = 0, 0.0
        self.control_ms: list[float] = []
        self.tick_ms: list[float] = []
        self.simulator = ReefSimulator(world, cfg.simulator, sim_rng)
        self.belief = Belief(OccupancyMap(world.size_m, cfg.simulator.camera, cfg.map), cfg.belief)
        planner = HighLevelPlanner(self.belief, cfg.pilot.fields, render_prompt, draw or (lambda belief: ()),
                                   cfg.planner)
        latency = _latency(advisor, cfg.latency)
        self.driver: LocalPlanner = (
            PdController(vehicle=cfg.simulator.vehicle) if cfg.driver == "pd"
            else DdpMppi(cfg.controller, cfg.simulator.vehicle, control_rng))
        # All that can be refused has been looked at: only now is a folder made.
        self.writer = RunWriter(folder, COLUMNS)
        self.attempts = AttemptRecorder(folder)
        self.frames = FrameRecorder(self.writer, cfg.record)
        self.clock = SimulatedClock(latency, clock_rng)
        self.clock.thread.warm_up(advisor)
        self.pilot = Pilot(self.belief, planner, self.driver, advisor, RuleAdvisor(REEF_RULES), self.clock, self.emit,
                           self.attempts, cfg.pilot)
        self.sensed: Sensed | None = None
        self.collisions = self.calls = 0
        self.end_reason = ""
        self.listeners: list[Callable[[dict[str, Any]], None]] = []
        """Called with every event, as it is written to events.jsonl."""
        self._covered: set[int] = set()
        self._wall = self._stood_still_s = 0.0

    def emit(self, event: str, **fields: Any) -> None:
        """Append an event at the present tick."""
        self.calls += event == "question"
        self.writer.event(self.step, self.t, event, **fields)
        for hear in self.listeners:
            hear({"step": self.step, "t": self.t, "event": event, **fields})

    def stood_still(self, seconds: float) -> None:
        """Leave a pause of `seconds` of wall time that ends now out of the run's time and of measured latencies."""
        self._stood_still_s += seconds
        self.clock.stood_still(seconds)

    def run(self, observers: Sequence[Observer] = ()) -> dict[str, Any]:
        """Run to the end; returns metrics and timing together."""
        started = time.perf_counter()
        self._begin()
        try:
            while not self.end_reason:
                self.advance()
                for observer in observers:
                    observer.tick(self)
                    self.end_reason = self.end_reason or observer.stop_requested()
        except KeyboardInterrupt:
            self.end_reason = "stopped by the operator"
        finally:
            self.clock.withdraw()
            self.emit("end", reason=self.end_reason or "failed")
            self.clock.close()
            self.attempts.close()
            self.writer.close()
            self._wall = time.perf_counter() - started - self._stood_still_s
        return self._finish()

    def advance(self) -> None:
        """One control tick: sense, think, act, record."""
        cfg, dt = self.cfg, self.cfg.control_period_s
        begun = time.perf_counter()
        sensed = self.sensed = self.simulator.sense(dt if self.step else 0.0)
        self.frames.offer(self.step, self.t, self.belief.map.cells, sensed.frame)
        thinking, waited = time.perf_counter(), self.clock.waited_s
        command = self.pilot.tick(self.t, sensed.frame, sensed.pose, sensed.velocity)
        waited = self.clock.waited_s - waited  # simulated time stood still for a reply: no part of the control period
        self.control_ms.append(1e3 * (time.perf_counter() - thinking - waited))
        contacts = self.simulator.act(command, dt)
        self.step += 1
        self.t = round(self.step * dt, 9)
        for x, y, obstacle in contacts:
            self.collisions += 1
            self.emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)
        self._cover()
        self._row(sensed, command)
        self.tick_ms.append(1e3 * (time.perf_counter() - begun - waited))
        if cfg.stop_when_covered and len(self._covered) == len(self.world.clusters):
            self.end_reason = "coverage complete"
        elif self.pilot.end_reason:
            self.end_reason = self.pilot.end_reason
        elif self.t >= cfg.time_limit_s - 1e-9:
            self.end_reason = "time limit"

    def _cover(self) -> None:
        fractions = self.simulator.coverage.fractions
        for k in np.flatnonzero(self.simulator.coverage.covered()):
            if int(k) not in self._covered:
                self._covered.add(int(k))
                self.emit("cluster_covered", name=self.world.clusters[k].name, fraction=round(float(fractions[k]), 4))

    def _row(self, sensed: Sensed, command: tuple[float, float]) -> None:
        state, goal, plan = self.simulator.vehicle.state, self.belief.goal, self.pilot.plan
        self.writer.row(self.step, self.t, *(float(v) for v in state[:6]), *sensed.pose, *command,
                        goal[0] if goal else "", goal[1] if goal else "", self.simulator.clearance_m,
                        int(plan.ok) if plan else 1, self.coverage, len(self._covered))

    @property
    def coverage(self) -> float:
        """Share of the true clusters covered so far."""
        return len(self._covered) / len(self.world.clusters)

    def _begin(self) -> None:
        save_world(self.world, self.writer.folder / "world.yaml")
        self.writer.yaml("config.yaml", {
            "system": "reef", "world": self.world.name, "advisor": self.advisor.name, "variant": self.variant,
            "seed": self.seed, "mission": to_mapping(self.cfg), "provenance": provenance()})
        self.emit("start", world=self.world.name, advisor=self.advisor.name, variant=self.variant, seed=self.seed,
                  clusters_total=len(self.world.clusters))
        self._cover()

    def _finish(self) -> dict[str, Any]:
        control = np.array(self.control_ms) if self.control_ms else np.zeros(1)
        ticks = np.array(self.tick_ms) if self.tick_ms else np.zeros(1)
        timing = {"wall_time_s": round(self._wall, 3),
                  "realtime_factor": round(self.t / self._wall, 2) if self._wall else 0.0,
                  "control_ms_median": round(float(np.median(control)), 3),
                  "control_ms_p99": round(float(np.percentile(control, 99)), 3),
                  "tick_ms_median": round(float(np.median(ticks)), 3),
                  "tick_ms_p99": round(float(np.percentile(ticks, 99)), 3)}
        metrics = compute_metrics(self.writer.folder)
        self.writer.json("metrics.json", metrics)
        histogram, edges = np.histogram(control, bins=np.linspace(0.0, max(10.0, math.ceil(control.max())), 41))
        self.writer.json("timing.json", {**timing, "control_ms_histogram": {
            "counts": histogram.tolist(), "edges": [round(float(e), 4) for e in edges]}})
        return {**metrics, **timing}


def _latency(advisor: Advisor, spec: str) -> LatencyCfg:
    latency = latency_for(advisor, spec)
    return parse_latency(PAPER_LATENCY) if spec == "auto" and latency == parse_latency("0") else latency
