"""One mission from start to end: world, configuration and advisor in, run folder out."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import DEADLINE_S
from coral.advisor.log import AttemptRecorder
from coral.advisor.question import Advisor
from coral.config import checked, to_mapping
from coral.errors import InputError
from coral.reef.decide.own_parts import Check, Wanted, find_trigger, find_verifier
from coral.reef.decide.planner import Draw
from coral.reef.drive.controllers import MakeController, controller_maker, part_name
from coral.reef.eyes.backends import open_eyes
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.assembly import Deciding, decider_of, latency_of, make_robot, planned
from coral.reef.mission.bound import oracle_bound
from coral.reef.mission.judge import MissionJudge
from coral.reef.mission.loop import MissionLoop, SimulatedTicks
from coral.reef.mission.metrics import compute_metrics
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import COLUMNS, FrameRecorder
from coral.reef.mission.word_judge import instructed
from coral.reef.mission.word_oracle import true_answer
from coral.reef.pilot.leftover import chain_of, what_is_left
from coral.reef.simulation.simulator import ReefSimulator, SimulatedVehicle
from coral.reef.world.world import ReefWorld, save_world
from coral.run_files import RunFiles, SurveyFiles
from coral.run_loop import Observer, run_to_end, stoppable, timing_of
from coral.runs import RunWriter, provenance, require_empty


class Mission(MissionLoop):
    """Couples the simulated reef with the pilot of its robot, and records the mission."""

    def __init__(
        self,
        world: ReefWorld,
        cfg: MissionCfg,
        advisor: Advisor,
        folder: Path,
        *,
        seed: int = 0,
        variant: str = "full",
        preset: str = "clear",
        draw: Draw | None = None,
        controller: str | MakeController | None = None,
        trigger: str | Wanted | None = None,
        verifier: str | Check | None = None,
        begins: Callable[[], None] = lambda: None,
    ) -> None:
        """Check everything, then create the run folder.

        Args:
            world: World to survey.
            cfg: Configuration, with the variant applied.
            advisor: Who decides.
            folder: Run folder, new or empty.
            seed: Seed of all random numbers.
            variant: Name of the variant, for the record.
            preset: Name of the water and sensors, for the record.
            draw: Draws the pictures of questions; None for no pictures.
            controller: Replaces `cfg.driver`: a name, or a function of a `ControllerSetup`.
            trigger: Replaces the smart trigger; see `find_trigger`.
            verifier: Checks answers that the planner's own checks pass; see `find_verifier`.
            begins: Called when the inputs are checked, before anything that may take long.

        Raises:
            InputError: A value is out of range, a name is unknown, or the folder is not empty.
        """
        if controller is not None:
            cfg = dataclasses.replace(cfg, driver=part_name(controller))
        cfg = checked(cfg, "--cfg")
        if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
            raise InputError("--seed", "", repr(seed), "a number of 0 or more")
        cfg = instructed(cfg, world.mission)
        make_driver = controller_maker(cfg.driver if controller is None else controller)
        wanted, verify = find_trigger(trigger), find_verifier(verifier)
        exchanged = {"controller": controller, "trigger": trigger, "verifier": verifier}
        self.exchanged = {name: part_name(part) for name, part in exchanged.items() if part is not None}
        """Parts that replace ours, by name, for the record."""
        budget = cfg.pilot.budget.within(DEADLINE_S)
        cfg = dataclasses.replace(cfg, pilot=dataclasses.replace(cfg.pilot, budget=budget))
        of_sensors, of_driver, of_clock = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3))
        advisor = decider_of(cfg, advisor, seed, world)
        self.world, self.cfg, self.seed, self.variant, self.advisor = world, cfg, seed, variant, advisor
        eyes = self.eyes = open_eyes(cfg.perception, depth=cfg.depth, painted=True)
        self.preset = preset
        """Name of the water and sensors, for the record; `cfg` and `world` have their values."""
        if eyes is not None and not cfg.simulator.pictures:
            cfg = self.cfg = dataclasses.replace(cfg, simulator=dataclasses.replace(cfg.simulator, pictures=True))
        latency = latency_of(cfg, advisor)
        require_empty(folder)
        begins()
        self.simulator = ReefSimulator(world, cfg.simulator, of_sensors)
        cells = OccupancyMap(world.size_m, cfg.simulator.camera, cfg.map, cfg.simulator.sonar)
        commands = planned(world, cfg)
        # All inputs have been validated: create the folder only now.
        self.writer = RunWriter(folder, COLUMNS)
        sim = self.simulator
        self.judge = MissionJudge(world, sim.scene, sim.coverage, sim.imaging, folder, self.emit)
        self.attempts = AttemptRecorder(folder)
        self.frames = FrameRecorder(self.writer, cfg.record)
        self.clock = SimulatedClock(latency, of_clock)
        self.clock.thread.warm_up(advisor)
        deciding = Deciding(
            advisor=advisor,
            log=self.attempts,
            draw=draw or (lambda outlook: ()),
            make_driver=make_driver,
            wanted=wanted,
            verify=verify,
            commands=commands,
        )
        self.vehicle = SimulatedVehicle(self.simulator, cfg.control_period_s, self.emit)
        robot = make_robot(
            cfg,
            deciding,
            self.vehicle,
            self.simulator.pose,
            Belief(cells, cfg.belief),
            self.clock,
            of_driver,
            self.emit,
            eyes=eyes,
        )
        super().__init__(robot, SimulatedTicks(cfg.control_period_s))
        self.driver = robot.driver
        self.listeners: list[Callable[[dict[str, Any]], None]] = []
        """Functions called with every event, as written to events.jsonl."""
        self._wall = self._stood_still_s = 0.0

    def emit(self, event: str, **fields: Any) -> None:
        """Append an event at the present tick."""
        self.count(event, fields)
        self.writer.event(self.step, self.t, event, **fields)
        for hear in self.listeners:
            hear({"step": self.step, "t": self.t, "event": event, **fields})

    def stood_still(self, seconds: float) -> None:
        """Exclude a pause of `seconds` of wall time, ending now, from the run's time and from measured latencies."""
        self._stood_still_s += seconds
        self.clock.stood_still(seconds)

    def run(self, observers: Sequence[Observer[Mission]] = ()) -> dict[str, Any]:
        """Run to the end. Return metrics and timing together."""
        started = time.perf_counter()
        try:
            with stoppable(self):
                self._begin()
                run_to_end(self, observers)
        finally:
            try:
                self.clock.withdraw()
                self.pilot.stop(self.end_reason or "failed")
                self.emit("left", clusters=what_is_left(self.belief), centroids=chain_of(self.belief))
                self.frames.keep_final_map(self.step, self.belief.map.cells)
                judging = self._judged()
                self.emit("end", reason=self.end_reason or "failed")
            finally:  # even if the disk is full
                self.clock.close()
                try:
                    self.frames.close()
                finally:
                    self.attempts.close()
                    self.writer.close()
                    self.judge.close()
            self._wall = time.perf_counter() - started - self._stood_still_s - judging
        return self._finish()

    def located(self) -> None:
        """Keep pictures and map, if they are due."""
        if self.robot.picture is not None:
            self.frames.offer(self.step, self.t, self.belief.map.cells, self.robot.picture, self.robot.taken_at)

    def commanded(self) -> str:
        """Judge and record the tick. Return why the mission is over, or ""."""
        self.judge.note(self.step, self.t, self.simulator.pose, self.simulator.taken)
        self._row()
        if self.cfg.stop_when_covered and self.coverage == 1.0:
            return "coverage complete"
        late = self.t >= self.cfg.time_limit_s - 1e-9
        return self.robot.surfaced or self.pilot.end_reason or ("time limit" if late else "")

    def _row(self) -> None:
        robot, simulator = self.robot, self.simulator
        odometry, goal, plan = robot.seen.pose, robot.belief.goal, robot.pilot.plan
        assert odometry is not None
        self.writer.row(
            self.step,
            self.t,
            *(float(v) for v in simulator.vehicle.state[:6]),
            *robot.pose,
            *robot.command,
            goal[0] if goal else "",
            goal[1] if goal else "",
            simulator.clearance_m,
            int(plan.ok) if plan else 1,
            self.coverage,
            len(self.judge.covered),
            *odometry.value,
        )

    @property
    def coverage(self) -> float:
        """Share of the true clusters covered so far."""
        return self.judge.coverage

    def _begin(self) -> None:
        save_world(self.world, self.writer.folder / SurveyFiles.WORLD)
        self.writer.yaml(
            RunFiles.CONFIG,
            {
                "system": "reef",
                "world": self.world.name,
                "advisor": self.advisor.name,
                "variant": self.variant,
                "preset": self.preset,
                "seed": self.seed,
                **({"own_parts": self.exchanged} if self.exchanged else {}),
                "mission": to_mapping(self.cfg),
                "provenance": provenance(),
            },
        )
        self.emit(
            "start",
            world=self.world.name,
            advisor=self.advisor.name,
            variant=self.variant,
            preset=self.preset,
            seed=self.seed,
            clusters_total=len(self.world.clusters),
            **({"own_parts": self.exchanged} if self.exchanged else {}),
        )
        if self.instruction:
            self.emit("instruction", text=self.instruction, by="start")
        self.judge.note(0, 0.0, self.simulator.pose)

    def _judged(self) -> float:
        """Emit the judge's final record. Return the wall time that this took (s)."""
        begun, sim, meter = time.perf_counter(), self.cfg.simulator, self.simulator.imaging
        # The bound takes seconds to plan: only if there is something to compare with it.
        soon = None
        if self.end_reason and meter.inspected >= 0.9 - 1e-6:
            visibility_m = sim.noise.visibility_m
            soon = oracle_bound(self.world, sim.camera, sim.imaging, visibility_m, sim.vehicle).time_s
        if self.cfg.decider == "oracle" and self.judge.words is not None:
            self.answer = true_answer(self.world)
        verdict = self.judge.verdict(self.belief.tracks, self.collisions, self.instruction, self.answer, soon)
        self.emit("judged", **verdict)
        return time.perf_counter() - begun

    def _finish(self) -> dict[str, Any]:
        timing = timing_of(self._wall, self.t, control_ms=self.control_ms, tick_ms=self.tick_ms)
        metrics = compute_metrics(self.writer.folder)
        self.writer.json(RunFiles.METRICS, metrics)
        self.writer.json(RunFiles.TIMING, timing)
        return {**metrics, **timing}
