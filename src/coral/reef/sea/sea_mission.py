"""A survey in real time: vehicle, camera and advisor in, run folder out.

The counterpart of `Mission` without a simulator: nothing here knows the truth, and nothing in a tick waits.
"""

from __future__ import annotations

import dataclasses
import itertools
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.prompt import render as render_prompt
from coral.advisor.question import Advisor, Picture
from coral.advisor.rules import RuleAdvisor
from coral.advisor.thread import AdvisorThread
from coral.config import Positive
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.planner import HighLevelPlanner
from coral.reef.drive.controller import DdpMppi
from coral.reef.drive.delay_aware_driver import DelayAwareDriver
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.metrics import compute_metrics
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import PicturePose
from coral.reef.pilot.guard import Reading
from coral.reef.pilot.leftover import what_is_left
from coral.reef.pilot.pilot import Command, Pilot
from coral.reef.sea.link import VehicleLink, VehicleReport
from coral.reef.sea.local_frame import LocalFrame
from coral.reef.sea.loop import FixedRate, IdleCollector, collected_when_idle, prompt_threads
from coral.reef.sea.operator import OperatorWords, VehicleOrders, Word
from coral.reef.sea.picture import LatestShot
from coral.reef.sea.record import SeaRecord
from coral.reef.sea.safety import SafetyCfg, SafetyMonitor
from coral.reef.sea.sonar_reading import LatestHeard
from coral.reef.sea.stages import StageTimes
from coral.reef.sea.supervisor import Supervisor
from coral.reef.sea.survey_alignment import SavedMap, SurveyAlignment
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.sea.survey_head import write_head
from coral.reef.simulation.faults import FaultySensors, parse_fault
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.sensing import Attitude, Stamped, VehicleObservation
from coral.reef.vehicle.states import PilotState
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld
from coral.run_loop import Observer, timing_of

OWN_MAP, TRUTH = "the vehicle's own map", "the truth of a simulated reef"
ORDER_S = 6.0
"""At the end the last order is awaited for so long."""


@dataclass(frozen=True, kw_only=True)
class SailCfg:
    """What a survey in real time needs besides a mission's configuration."""

    mission: MissionCfg = field(default_factory=MissionCfg)
    safety: SafetyCfg = field(default_factory=SafetyCfg)
    depth_m: Positive = 1.0
    """Depth to hold."""
    response: VehicleResponse | None = None
    """How the vehicle follows its set-points, as `coral reef identify` measured it; None: as the simulated one does."""


@dataclass(frozen=True, kw_only=True)
class Crew:
    """The parts that a survey is given."""

    link: VehicleLink
    camera: LatestShot
    advisor: Advisor
    sonar: LatestHeard | None = None
    """None: the vehicle has none."""
    words: OperatorWords = field(default_factory=OperatorWords)
    world: ReefWorld | None = None
    """The simulated reef; None in real water."""
    true_pose: Callable[[], Pose | None] = lambda: None
    """Where the vehicle truly is in it."""
    draw: Callable[[Belief], tuple[Picture, ...]] | None = None
    """Draws the pictures of a question."""


class SeaMission:
    """Couples a vehicle with the pilot at a fixed rate, and records what happens."""

    def __init__(
        self,
        area: SurveyArea,
        cfg: SailCfg,
        crew: Crew,
        folder: Path,
        *,
        frame: LocalFrame | None = None,
        belief: Belief | None = None,
        saved: SavedMap | None = None,
        seed: int = 0,
        about: dict[str, Any] | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        decision_clock: SimulatedClock | WallClock | None = None,
        threaded: bool = True,
    ) -> None:
        """Set up a survey that has not begun.

        Args:
            area: Where it is.
            cfg: Configuration.
            crew: Vehicle, camera, advisor.
            folder: Run folder, new or empty.
            frame: From the vehicle's frame to the survey's.
            belief: What an earlier survey found, where the vehicle is in its frame; empty by default.
            saved: What an earlier survey found, where the vehicle's place on it must be found first.
            seed: Seed of the controller's samples.
            about: Further entries of config.yaml, such as the names on the command line.
            clock: Monotonic time (s), that of the vehicle's stamps.
            sleep: Waits so long (s).
            decision_clock: Clock of the advisor's answers; real time by default.
            threaded: False for tests: orders and recording are then done in the caller's thread.
        """
        mission = cfg.mission
        self.area, self.cfg, self.crew, self.frame, self.seed = area, cfg, crew, frame or LocalFrame(), seed
        self.about = about or {}
        self._clock, self._sleep, self._threaded = clock, sleep, threaded
        sim = mission.simulator
        self.belief = belief or Belief(OccupancyMap(area.size_m, sim.camera, mission.map, sim.sonar), mission.belief)
        self._forbidden = area.forbidden(mission.map.cell_m, self.belief.map.target.shape)
        self.belief.map.close_off(self._forbidden)
        self.response = cfg.response or VehicleResponse.of_vehicle(mission.simulator.vehicle)
        margin_m = mission.controller.margin_m + self.response.margin_m
        controller = DdpMppi(
            dataclasses.replace(mission.controller, margin_m=margin_m),
            mission.simulator.vehicle,
            np.random.default_rng([seed, 1]),
            control_period_s=mission.control_period_s,
            response=self.response,
        )
        top_m_s = mission.simulator.vehicle.max_speed_m_s
        self.driver = DelayAwareDriver(controller, self.response, top_m_s, mission.control_period_s)
        self.step, self.t, self.end_reason = 0, 0.0, ""
        self.calls = self.collisions = 0
        self.control_ms: list[float] = []
        """Work of each tick (ms): from the vehicle's report to the end of the tick."""
        self.command: Command = (0.0, 0.0)
        self.report = VehicleReport()
        """The last report."""
        self.pose: Pose | None = None
        """The last pose in the survey's frame."""
        self.record = SeaRecord(folder, mission.record, crew.world, mission.simulator, threaded=threaded)
        self.record.listeners.append(self._count)
        self._thread = None if decision_clock is not None else AdvisorThread()
        if self._thread is not None:
            self._thread.warm_up(crew.advisor)
        self._decision_clock = decision_clock
        self.orders = VehicleOrders(crew.link, threaded=threaded)
        self.safety = SafetyMonitor(cfg.safety, area, mission.time_limit_s)
        self._faults = FaultySensors(map(parse_fault, mission.faults))
        self._recording = True
        self._decisions = itertools.count()
        self.alignment: SurveyAlignment | None = None
        """The search for the vehicle's place on the saved map, in a survey that needs one."""
        if saved is not None:
            self.alignment = SurveyAlignment(saved, area.start, self._forbidden, self.emit, threaded=threaded)
        self._idle: IdleCollector | None = None
        self._awaited = ""
        self._stages = StageTimes(clock)
        self._shown_s = 0.0

    def align(self, start: Pose | None = None, *, trust_heading: bool) -> None:
        """Take what the vehicle reports now as the survey's start."""
        report = self.crew.link.report()
        if report.pose is not None:
            self.frame = LocalFrame.from_start(report.pose, start or self.area.start, trust_heading=trust_heading)

    @property
    def notice(self) -> str:
        """What would end the vehicle's state, and what the operator is asked; "" if there is nothing to say."""
        alignment = "" if self.alignment is None else self.alignment.status
        return " - ".join(text for text in (self._awaited, alignment) if text)

    def emit(self, event: str, **fields: Any) -> None:
        """Record an event at the present tick."""
        self.record.event(self.step, self.t, event, **fields)

    def run(self, observers: Sequence[Observer[SeaMission]] = ()) -> dict[str, Any]:
        """Survey until the end. The vehicle must be armed. Return metrics and timing together."""
        with collected_when_idle() as idle, prompt_threads():
            self._begin()
            self._idle = idle
            try:
                while not self.end_reason:
                    self.advance()
                    shown = self._clock()
                    for observer in observers:
                        observer.tick(self)
                        self.end_reason = self.end_reason or observer.stop_requested()
                    self._shown_s = self._clock() - shown
            finally:
                result = self._finish()
        return result

    def advance(self) -> None:
        """Run one control tick."""
        self.rate.wait()
        now = self._clock()
        self._stages.begin(page_before=self._shown_s, woken=self.rate.behind_s)
        self.t = round(now - self._began, 6)
        report = self.report = self.crew.link.report()
        pose = self.pose = None if report.pose is None else self.frame.to_survey(report.pose)
        self._tell_texts(report)
        self._stages.mark("report")
        reading = self.pilot.sense(self._faults.apply(self._observe(report, pose)))
        command = self.pilot.drive(reading)
        self._stages.mark("pilot")
        words = self.crew.words.take()
        self.supervisor.update(now, self.t, report, pose, words)
        if self.alignment is not None:
            self._seek_place(words)
        self._tell_awaited()
        self.command = command if self.states.state is PilotState.SURVEYING else (0.0, 0.0)
        self.driver.note(self.command)
        if self.supervisor.sends_commands:
            self.crew.link.command(*self.response.setpoint(*self.command), self.cfg.depth_m)
        self._stages.mark("command")
        self.step += 1
        self._record(report, reading)
        self._stages.mark("record")
        if self.pilot.end_reason and not self.supervisor.returning and self.states.state is not PilotState.TAKEN_OVER:
            self.supervisor.complete(self.t, self.pilot.end_reason)
        self.end_reason = self.supervisor.end_reason
        late, spare_s = self.rate.count.late, self.rate.finish()
        if self.rate.count.late > late:
            self.emit("late_tick", behind_ms=round(1e3 * (self.rate.period_s - spare_s)), **self._stages.told_ms())
        self.control_ms.append(1e3 * (self._clock() - now))
        if self._idle is not None:
            self._idle.offer(spare_s)

    @property
    def coverage(self) -> float:
        """Share of the clusters: of the true ones in a simulated reef, else of those on the vehicle's own map."""
        if self.record.truth is not None:
            return self.record.truth.coverage
        return self._own()[1]

    def _begin(self) -> None:
        cfg, crew = self.cfg.mission, self.crew
        about = {"world": self.area.name, "advisor": crew.advisor.name, "variant": "full", "seed": self.seed}
        about |= self.about
        write_head(self.record.writer, self.area, crew.world, about, self.cfg, self.response, self.frame)
        total = 0 if crew.world is None else len(crew.world.clusters)
        self.emit("start", **about, clusters_total=total, judged_by=OWN_MAP if crew.world is None else TRUTH)
        self.clock = self._decision_clock or WallClock(self._thread)
        self.pilot = self._make_pilot()
        self.states = self.pilot.safety.states
        self.supervisor = Supervisor(self.states, self.orders, self.safety, self.emit, self._go_home)
        report = crew.link.report()
        self.safety.accept(report)
        self._tell_texts(report)
        self._began = self._clock()
        self.rate = FixedRate(cfg.control_period_s, self._clock, self._sleep)

    def _make_pilot(self) -> Pilot:
        """Make the pilot that decides by the present belief."""
        cfg, crew = self.cfg.mission, self.crew
        draw = crew.draw or (lambda belief: ())
        return Pilot(
            self.belief,
            HighLevelPlanner(self.belief, cfg.pilot.fields, render_prompt, draw, cfg.planner),
            self.driver,
            crew.advisor,
            RuleAdvisor(REEF_RULES),
            self.clock,
            self.emit,
            self.record.attempt,
            cfg.pilot,
            self._decisions,
        )

    def _seek_place(self, words: Iterable[tuple[Word, str]]) -> None:
        """Go on looking for the vehicle's place on the saved map; take that map over on the operator's word."""
        assert self.alignment is not None
        for word, source in words:
            self.alignment.say(word, source)
        if self.supervisor.returning or self.states.state not in (PilotState.SURVEYING, PilotState.HOLDING):
            return
        found = self.alignment.update(self.t, self.belief)
        if found is None:
            return
        belief, shift = found
        self.clock.withdraw()
        self.belief, self.frame = belief, self.frame.then(shift)
        belief.map.close_off(self._forbidden)
        self.area = self.safety.area = self.area.with_start(shift.to_survey(self.area.start))
        states = self.pilot.safety.states
        self.pilot = self._make_pilot()
        self.pilot.safety.states = states
        self.driver.reset()
        self.emit(
            "frame",
            **dataclasses.asdict(self.frame),
            start=list(self.area.start),
            shift=list(dataclasses.astuple(shift)),
        )

    def _observe(self, report: VehicleReport, pose: Pose | None) -> VehicleObservation:
        """Put a report and the newest picture into the pilot's input, with stamps on the survey's clock."""
        began, shot = self._began, self.crew.camera.latest
        heard = None if self.crew.sonar is None else self.crew.sonar.latest
        std, level = report.position_std_m, report.roll_rad is not None and report.pitch_rad is not None
        return VehicleObservation(
            t=self.t,
            pose=None if pose is None else Stamped(report.pose_stamp_s - began, pose),
            velocity=None if report.velocity is None else Stamped(report.velocity_stamp_s - began, report.velocity),
            frame=None if shot is None or shot.frame is None else Stamped(shot.stamp_s - began, shot.frame),
            covariance=None if std is None else np.diag([std**2, std**2, 0.0]),
            attitude=Stamped(
                report.attitude_stamp_s - began,
                Attitude(
                    roll=report.roll_rad,  # type: ignore[arg-type]
                    pitch=report.pitch_rad,  # type: ignore[arg-type]
                    depth_m=report.depth_m,
                    altitude_m=report.altitude_m,
                ),
            )
            if level and report.depth_m is not None
            else None,
            sonar=None if heard is None else Stamped(heard.stamp_s - began, heard.image),
        )

    def _tell_texts(self, report: VehicleReport) -> None:
        for text in report.texts:
            self.emit("vehicle_text", severity=text.severity, text=text.text)

    def _tell_awaited(self) -> None:
        guard = self.cfg.mission.pilot.guard
        found = self.supervisor.awaits(guard.recover_s, guard.surface_after_s)
        if found != self._awaited:
            self._awaited = found
            self.emit("awaited", state=self.states.state.value, reason=self.states.reason, ends_when=found)

    def _go_home(self) -> None:
        self.pilot.go_home(*self.area.start[:2])

    def _own(self) -> tuple[float, float, int]:
        """Distance to the nearest known obstacle (m), share of the known clusters that are done, their number."""
        belief = self.belief
        near = [track for track in belief.tracks if not track.far]
        done = sum(track.visited for track in near)
        cells, pose = belief.map, belief.pose
        away = float(cells.distance_near(pose.x, pose.y, self.cfg.mission.pilot.local_m)[cells.index(pose.x, pose.y)])
        hull_m = self.cfg.mission.simulator.vehicle.hull_radius_m
        return away - hull_m, done / len(near) if near else 0.0, done

    def _record(self, report: VehicleReport, reading: Reading) -> None:
        belief, plan = self.belief, self.pilot.plan
        goal = belief.goal or (float("nan"), float("nan"))
        ok = float(plan.ok) if plan is not None else 1.0
        state = (*(report.velocity or (0.0, 0.0, 0.0)), *self.command, *goal, ok)
        self.record.tick(self.step, self.t, belief.pose, self.crew.true_pose(), state, self._own())
        if belief.frame is not None:
            self.record.offer_frame(self.step, self.t, belief.map.cells, belief.frame, self._taken_at(reading))
        if self._recording and self.record.work.failure:
            self._recording = False
            self.emit("recording_stopped", reason=self.record.work.failure)

    def _taken_at(self, reading: Reading) -> PicturePose | None:
        """Where the tick's new picture was taken; None without one."""
        if reading.frame is None or reading.frame_pose is None:
            return None
        level = reading.attitude or Attitude(roll=0.0, pitch=0.0, depth_m=self.cfg.depth_m)
        return PicturePose(
            pose=reading.frame_pose,
            odometry=reading.frame_pose,
            height_m=self.cfg.mission.simulator.camera.altitude_m,
            roll=level.roll,
            pitch=level.pitch,
        )

    def _count(self, event: dict[str, Any]) -> None:
        self.calls += event["event"] == "question"
        self.collisions += event["event"] == "collision"

    def _finish(self) -> dict[str, Any]:
        """Leave the vehicle as the end asks for, write the results, and return them."""
        self.end_reason = self.end_reason or "failed"
        self.supervisor.finish()
        self.pilot.stop(self.end_reason)
        if self._threaded:
            self.orders.wait(ORDER_S, self._sleep)
        refused = [result for result in self.orders.results() if result.refusal]
        for result in refused:
            self.emit("order_refused", order=result.order, reason=result.refusal)
        self.orders.close()
        self.clock.withdraw()
        self.emit("left", clusters=what_is_left(self.belief))
        record, tracks = self.record, self.belief.tracks
        near = sum(not track.far for track in tracks)
        if record.truth is not None:
            judge, emit, step, t = record.truth, record.writer.event, self.step, self.t
            record.work.offer(lambda: emit(step, t, "judged", **judge.verdict(tracks)))
        else:
            self.emit("judged", tracks=near)
        self.emit("end", reason=self.end_reason)
        self.clock.close()
        if self.alignment is not None:
            self.alignment.close()
        if self._thread is not None:
            self._thread.close()
        record.close()
        return self._results()

    def _results(self) -> dict[str, Any]:
        count, record = self.rate.count, self.record
        metrics = compute_metrics(record.folder) | {
            "judged_by": OWN_MAP if record.truth is None else TRUTH,
            "late_ticks": count.late,
            "skipped_ticks": count.skipped,
            "ticks": count.done,
            "worst_tick_ms": round(1e3 * count.worst_s, 1),
            "tick_ms_p999": round(1e3 * float(np.percentile(count.ends_s or [0.0], 99.9)), 1),
            "recording_failure": record.work.failure,
            "recording_dropped": record.work.dropped,
            "tether_turns": round(self.report.tether_turns, 2),
            **({} if self.alignment is None else {"alignment": self.alignment.outcome or "not decided"}),
        }
        timing = timing_of(self._clock() - self._began, self.t, control_ms=self.control_ms)
        if not record.work.failure:
            record.writer.json("metrics.json", metrics)
            record.writer.json("timing.json", timing)
        return {**metrics, **timing}
