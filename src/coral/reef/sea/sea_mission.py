"""A survey in real time: what stands round the mission loop at sea.

The loop and the robot are those of a simulated mission. Nothing here knows the truth, and nothing in a tick waits.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.question import Advisor
from coral.advisor.thread import AdvisorThread
from coral.reef.decide.planner import Draw
from coral.reef.drive.delay_aware_driver import DelayAwareDriver
from coral.reef.map.belief import Belief
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.assembly import Deciding, decider_of, latency_in_real_time, make_robot
from coral.reef.mission.loop import MissionLoop
from coral.reef.mission.metrics import OWN_MAP, TRUTH, compute_metrics
from coral.reef.mission.word_judge import told_verdict
from coral.reef.pilot.leftover import chain_of, what_is_left
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.latest_reading import LatestReading, LatestShot
from coral.reef.sea.link import VehicleLink, VehicleReport
from coral.reef.sea.link_vehicle import LinkVehicle
from coral.reef.sea.operator import OperatorWords, VehicleOrders
from coral.reef.sea.real_time import RealTicks, little_garbage, prompt_threads
from coral.reef.sea.record import SeaRecord
from coral.reef.sea.safety import SafetyMonitor, SailCfg
from coral.reef.sea.supervisor import Supervisor
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.sensing import HeardImage
from coral.reef.vehicle.states import PilotState
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld
from coral.run_files import RunFiles
from coral.run_loop import Observer, timing_of

UNWIND = 0.8
"""At this share of the turns that the tether may have, the vehicle turns back on the spot, by all of them."""
LOST_S = 60.0
"""A resumed survey that has not found itself on the saved map by then says so."""
ORDER_S = 11.0
"""Longest wait for the last order at the end."""


@dataclass(frozen=True, kw_only=True)
class Crew:
    """The parts that a survey is given."""

    link: VehicleLink
    camera: LatestShot
    advisor: Advisor
    sonar: LatestReading[HeardImage] | None = None
    """None: the vehicle has none."""
    words: OperatorWords = field(default_factory=OperatorWords)
    world: ReefWorld | None = None
    """The simulated reef; None in real water."""
    true_pose: Callable[[], Pose | None] = lambda: None
    """Where the vehicle truly is in it."""
    draw: Draw | None = None
    """Draws the pictures of a question."""


class SeaMission(MissionLoop):
    """Stands round the loop in real time: supervises the vehicle, and records what happens."""

    def __init__(
        self,
        area: SurveyArea,
        cfg: SailCfg,
        crew: Crew,
        folder: Path,
        *,
        frame: LocalFrame | None = None,
        belief: Belief | None = None,
        landmarks: LandmarkMap | None = None,
        seed: int = 0,
        about: dict[str, Any] | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        decision_clock: SimulatedClock | WallClock | None = None,
        threaded: bool = True,
    ) -> None:
        """Set up a survey that has not begun; nothing is believed of the reef unless an earlier survey found it.

        `landmarks` are those of that survey, by which the localizer finds its frame.

        `about` are further entries of config.yaml. Both clocks are real by default; that of the advisor's answers may
        be another one. Without `threaded`, for tests, orders and recording are done in the caller's thread.
        """
        mission, sim = cfg.mission, cfg.mission.simulator
        self.area, self.cfg, self.crew, self.seed, self.about = area, cfg, crew, seed, about or {}
        self._clock, self._sleep, self._threaded = clock, sleep, threaded
        belief = belief or Belief(OccupancyMap(area.size_m, sim.camera, mission.map, sim.sonar), mission.belief)
        belief.map.close_off(area.forbidden(mission.map.cell_m, belief.map.target.shape))
        self.record = SeaRecord(folder, mission.record, crew.world, sim, threaded=threaded)
        advisor = decider_of(mission, crew.advisor, seed)
        self._thread = None if decision_clock is not None else AdvisorThread()
        if self._thread is not None:
            self._thread.warm_up(advisor)
        latency = latency_in_real_time(mission, advisor)
        self.clock = decision_clock or WallClock(self._thread, latency)
        response = self.response = cfg.response or VehicleResponse.of_vehicle(sim.vehicle)
        self.vehicle = LinkVehicle(crew.link, crew.camera, crew.sonar, frame or LocalFrame(), response, cfg.depth_m)
        robot = make_robot(
            mission,
            Deciding(advisor=advisor, log=self.record.attempt, draw=crew.draw or (lambda outlook: ())),
            self.vehicle,
            area.start,
            belief,
            self.clock,
            np.random.default_rng([seed, 1]),
            self.emit,
            response=response,
        )
        self.ticks = RealTicks(mission.control_period_s, clock, sleep)
        super().__init__(robot, self.ticks)
        self.record.listeners.append(lambda event: self.count(event["event"], event))
        self.states = self.pilot.safety.states
        """What the vehicle is doing, and why."""
        self.robot.localizer.recall(landmarks or LandmarkMap())
        self._placed: int | None = None
        """The saved landmarks that were recognised when it was told last."""
        crew.camera.attitude = lambda: self.robot.camera_attitude(self.robot.seen)
        self.orders = VehicleOrders(crew.link, threaded=threaded)
        self.safety = SafetyMonitor(cfg.safety, area, mission.time_limit_s, sees_m=lambda: self.belief.map.sees_m)
        go_home = partial(self.pilot.go_home, *area.start[:2])
        self.supervisor = Supervisor(self.states, self.orders, self.safety, self.emit, go_home)
        self._recording, self.notice = True, ""
        """notice: what would end the vehicle's state; "" if there is nothing to say."""
        self.picture_age_ms: list[float] = []
        """Age of each new picture in the tick that used it (ms): latency of the camera, time of the eyes, waiting."""

    @property
    def report(self) -> VehicleReport:
        """The vehicle's last report."""
        return self.vehicle.report

    @property
    def pose(self) -> Pose | None:
        """The last reported pose in the survey's frame, corrected by the localizer."""
        return None if self.vehicle.pose is None else self.robot.localizer.locate(self.vehicle.pose)

    @property
    def coverage(self) -> float:
        """Share of the clusters: of the true ones in a simulated reef, else of those on the vehicle's own map."""
        return self._own()[1] if self.record.truth is None else self.record.truth.judge.coverage

    def align(self, *, trust_heading: bool) -> None:
        """Take what the vehicle reports now as the survey's start."""
        report = self.crew.link.report()
        if report.pose is not None:
            self.vehicle.frame = LocalFrame.from_start(report.pose, self.area.start, trust_heading=trust_heading)

    def emit(self, event: str, **fields: Any) -> None:
        """Record an event at the present tick."""
        self.record.event(self.step, self.t, event, **fields)

    def run(self, observers: Sequence[Observer[SeaMission]] = ()) -> dict[str, Any]:
        """Survey until the end. The vehicle must be armed. Return metrics and timing together."""
        with little_garbage(), prompt_threads():
            self._begin()
            try:
                while not self.end_reason:
                    self.advance()
                    for observer in observers:
                        observer.tick(self)
                        self.end_reason = self.end_reason or observer.stop_requested()
            finally:
                result = self._finish()
        return result

    def advance(self) -> None:
        """Run one control tick."""
        super().advance()
        late = self.ticks.late
        behind_ms = round(1e3 * self.ticks.finish())
        if self.ticks.late > late:
            control_ms = round(self.control_ms[-1])
            self.emit("late_tick", behind_ms=behind_ms, woken_ms=self.ticks.woken_ms, control_ms=control_ms)

    def located(self) -> None:
        """Tell what the autopilot said, and note how old the picture is."""
        self._tell_texts(self.report)
        localizer = self.robot.localizer
        if bool(localizer.recognised) != bool(self._placed) or (self._placed is None and self.t >= LOST_S):
            self._tell_place()
        if self.robot.reading.frame is not None and self.robot.seen.frame is not None:
            self.picture_age_ms.append(1e3 * (self.t - self.robot.seen.frame.t))

    def decided(self) -> None:
        """Let the operator, the limits and the person at the joystick decide whether the vehicle drives."""
        self.supervisor.update(self.ticks.now_s, self.t, self.report, self.pose, self.crew.words.take())
        self._tell_awaited()
        if self.states.state is not PilotState.SURVEYING:
            self.robot.command = (0.0, 0.0)
        elif abs(twist := self.report.tether_turns) > UNWIND * self.cfg.safety.tether_turns and self.pilot.unwind(
            twist
        ):
            self.emit("unwind", turns=round(twist, 2))
        if isinstance(self.robot.driver, DelayAwareDriver):
            self.robot.driver.note(self.robot.command)
        self.vehicle.sends = self.supervisor.sends_commands

    def commanded(self) -> str:
        """Record the tick. Return why the survey is over, or ""."""
        self._record()
        truth, done = self.record.truth, self.pilot.end_reason
        if self.cfg.mission.stop_when_covered and truth is not None and truth.judge.coverage == 1.0:
            done = done or "coverage complete"
        if done and truth is not None and (answer := self.answer) is not None:
            self.record.work.offer(lambda: truth.judge.end_mission(answer))
        if done and not self.supervisor.returning and self.states.state is not PilotState.TAKEN_OVER:
            self.supervisor.complete(self.t, done)
        return self.supervisor.end_reason

    def _begin(self) -> None:
        crew = self.crew
        about = {"world": self.area.name, "advisor": crew.advisor.name, "variant": "full", "seed": self.seed}
        about |= self.about
        self.record.head(self.area, about, self.cfg, self.response, self.vehicle.frame)
        total = 0 if crew.world is None else len(crew.world.clusters)
        self.emit("start", **about, clusters_total=total, judged_by=OWN_MAP if crew.world is None else TRUTH)
        if self.instruction:
            self.emit("instruction", text=self.instruction, by="start")
        report = crew.link.report()
        self.safety.accept(report)
        self._tell_texts(report)
        self.vehicle.began_s = self.ticks.start()
        if isinstance(self.clock, WallClock):
            self.clock.restart()

    def _tell_texts(self, report: VehicleReport) -> None:
        for text in report.texts:
            self.emit("vehicle_text", severity=text.severity, text=text.text)

    def _tell_place(self) -> None:
        """Tell whether a resumed survey has found itself on the saved map."""
        localizer = self.robot.localizer
        self._placed = localizer.recognised
        if localizer.saved:
            x, y, theta = (round(value, 3) for value in localizer.hypotheses[0].map.error)
            self.emit("place", landmarks=localizer.saved, recognised=self._placed, x=x, y=y, theta=theta)

    def _tell_awaited(self) -> None:
        guard = self.cfg.mission.pilot.guard
        found = self.supervisor.awaits(guard.recover_s, guard.surface_after_s)
        if found != self.notice:
            self.notice = found
            self.emit("awaited", state=self.states.state.value, reason=self.states.reason, ends_when=found)

    def _own(self) -> tuple[float, float, int]:
        """Distance to the nearest known obstacle (m), share of the known clusters that are done, their number."""
        belief = self.belief
        near = [track for track in belief.tracks if not track.far]
        done = sum(track.visited for track in near)
        cells, pose = belief.map, belief.pose
        away = float(cells.distance_near(pose.x, pose.y, self.cfg.mission.pilot.local_m)[cells.index(pose.x, pose.y)])
        return away - self.cfg.mission.simulator.vehicle.hull_radius_m, done / len(near) if near else 0.0, done

    def _record(self) -> None:
        belief, plan, robot = self.belief, self.pilot.plan, self.robot
        goal = belief.goal or (float("nan"), float("nan"))
        ok = float(plan.ok) if plan is not None else 1.0
        state = (*(self.report.velocity or (0.0, 0.0, 0.0)), *robot.command, *goal, ok)
        odometry = self.vehicle.pose or belief.pose
        self.record.tick(self.step, self.t, belief.pose, odometry, self.crew.true_pose(), state, self._own())
        if robot.picture is not None:
            self.record.frames.offer(self.step, self.t, belief.map.cells, robot.picture, robot.taken_at)
        self.record.offer_survey(self.t, belief, robot.localizer.kept)
        if self._recording and self.record.work.failure:
            self._recording = False
            self.emit("recording_stopped", reason=self.record.work.failure)

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
        self._tell_place()
        self.emit("left", clusters=what_is_left(self.belief), centroids=chain_of(self.belief))
        record, tracks = self.record, self.belief.tracks
        near = sum(not track.far for track in tracks)
        if record.truth is not None:
            judge, emit, step, t, words = record.truth, record.writer.event, self.step, self.t, self.instruction
            record.work.offer(lambda: emit(step, t, "judged", **judge.verdict(tracks, words, self.answer)))
        else:
            self.emit("judged", tracks=near, **told_verdict(self.instruction, self.answer, None, self.collisions))
        self.emit("end", reason=self.end_reason)
        record.offer_survey(self.t, self.belief, self.robot.localizer.kept, last=True)
        self.clock.close()
        if self._thread is not None:
            self._thread.close()
        record.close()
        return self._results()

    def _results(self) -> dict[str, Any]:
        ticks, record = self.ticks, self.record
        metrics = compute_metrics(record.folder) | {
            "judged_by": OWN_MAP if record.truth is None else TRUTH,
            "late_ticks": ticks.late,
            "skipped_ticks": ticks.skipped,
            "ticks": ticks.done,
            "worst_tick_ms": round(1e3 * max(ticks.ends_s, default=0.0), 1),
            "tick_ms_p999": round(1e3 * float(np.percentile(ticks.ends_s or [0.0], 99.9)), 1),
            "recording_failure": record.work.failure,
            "recording_dropped": record.work.dropped,
            "tether_turns": round(self.report.tether_turns, 2),
            "position_sigma_m": round(math.hypot(*self.robot.localizer.sigma[:2]), 3),
        }
        wall_s = self._clock() - self.vehicle.began_s
        ages = {"picture_age_ms": self.picture_age_ms}
        timing = timing_of(wall_s, self.t, control_ms=self.control_ms, tick_ms=self.tick_ms, **ages)
        if not record.work.failure:
            record.writer.json(RunFiles.METRICS, metrics)
            record.writer.json(RunFiles.TIMING, timing)
        return {**metrics, **timing}
