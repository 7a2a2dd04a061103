"""The robot's side of a mission, tick by tick: perceive, decide when it matters, drive always (paper Alg. 1)."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.consult import Attempt
from coral.advisor.fallback import failed
from coral.advisor.question import Advisor
from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.own_parts import Verifier, Wanted
from coral.reef.decide.planner import AskedState, HighLevelPlanner
from coral.reef.decide.trigger import Cause, Firing, SmartTrigger
from coral.reef.drive.controller import Plan
from coral.reef.drive.controllers import LocalPlanner
from coral.reef.drive.cost_to_go import CostToGo
from coral.reef.drive.monitor import PathMonitor
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField
from coral.reef.pilot.consultation import Consultation, Decided, Emit
from coral.reef.pilot.goals import SURVEY_ENDED, Goals
from coral.reef.pilot.guard import Reading, SensorGuard
from coral.reef.pilot.look_round import YAW_RATE_RAD_S, LookRound
from coral.reef.pilot.pilot_cfg import PilotCfg
from coral.reef.pilot.safety import SafetyWatch
from coral.reef.vehicle.sensing import VehicleObservation, Velocity
from coral.reef.vehicle.states import Mover
from coral.reef.vehicle.vehicle import VehicleState
from coral.reef.world.geometry import Pose
from coral.reef.world.instruction import checked_words

Command = tuple[float, float]
"""Forward speed (m/s) and yaw rate (rad/s)."""

FAILURES: dict[Cause, str] = {
    "stuck": "the robot stood still on the way",
    "failure": "the controller found no way past obstacles",
    "deviation": "obstacles forced the robot off its path too often",
}
"""Why a goal was given up, in words for the next question."""

NOTHING_LEFT = "nothing left to explore"

SIGHT_TOLD_S, SIGHT_TOLD_M = 10.0, 1.0
"""How far the eyes see is told after so long at the earliest, and again when it has changed by so much."""


class Pilot:
    """Belief in, command out; the advisor is consulted on the side and never waited for."""

    def __init__(
        self,
        belief: Belief,
        planner: HighLevelPlanner,
        driver: LocalPlanner,
        advisor: Advisor,
        fallback: Advisor,
        clock: SimulatedClock | WallClock,
        emit: Emit,
        log: Callable[[Attempt], None],
        cfg: PilotCfg | None = None,
        wanted: Wanted | None = None,
        verifier: Verifier | None = None,
    ) -> None:
        self.cfg = cfg or PilotCfg()
        self.belief, self.planner, self.driver, self.clock = belief, planner, driver, clock
        self.route = planner.route
        self.trigger = SmartTrigger(self.cfg.trigger, wanted)
        self.monitor = PathMonitor(self.cfg.monitor)
        prepare_s = 0.0 if self.cfg.synchronous else self.cfg.prepare_s
        self.cost_to_go = CostToGo(
            belief,
            clock,
            self.cfg.fields,
            period_s=self.cfg.field_period_s,
            most_cells=self.cfg.field_cells,
            prepare_s=prepare_s,
            straight=not self.cfg.cost_to_go,
        )
        self.consultation = Consultation(
            planner, advisor, fallback, clock, self.cost_to_go, emit, log, self.cfg.budget, prepare_s, verifier
        )
        self.goals = Goals(belief, planner, clock, emit, self.trigger.new_goal, self.cfg)
        self._told: tuple[str, str] | None = None
        """New words of a mission in words and who said them, until the next tick takes them over."""
        self._unasked = False
        """Whether the instruction was changed since the last question."""
        layer = belief.map.layer
        guard = SensorGuard(
            belief.map.camera,
            belief.map.size_m,
            self.cfg.guard,
            None if layer is None else layer.sonar,
            sonar_alone=lambda: belief.map.sonar_alone,
        )
        self.safety = SafetyWatch(guard, emit)
        """Checks the sensors; its `states` say what the vehicle is doing, and why."""
        self._look_round = LookRound(belief)
        self.plan: Plan | None = None
        self.end_reason = ""
        """Why this robot has nothing more to do; "" again when it is asked anew and there is something."""
        self.homing = False
        """Whether it is on its way home, for good."""
        self._emit = emit
        self._last_firing: Firing | None = None
        self._known: set[int] = set()
        """Labels of the clusters that were on a map when a question was asked."""
        self._acting_until = self._began = -math.inf
        self._now, self._stood = 0.0, False
        self._blind = self._deaf = False
        self._sight: tuple[float, float] = 0.0, math.inf
        """When it was last told how far the eyes tell oysters from sea floor (s), and how far (m)."""
        self._decided = self._ended = False
        """Whether a decision has ended, and whether one has ended the survey."""

    @property
    def field(self) -> CostField | None:
        """The cost-to-go that the vehicle follows; None before the first tick."""
        return self.cost_to_go.field

    def tick(self, seen: VehicleObservation) -> Command:
        """Run one control period: check what was measured, take it in, return the command until the next."""
        return self.drive(self.sense(seen))

    def sense(self, seen: VehicleObservation) -> Reading:
        """Check what was measured. What it means for the vehicle's state is decided here."""
        return self.safety.update(seen)

    def drive(self, reading: Reading) -> Command:
        """Take in a checked reading, whose poses a robot may have corrected; return the command until the next."""
        self._take_words()
        if reading.frame is not None and reading.frame_pose is not None:
            self.belief.update(reading.frame, reading.frame_pose, reading.attitude)
            self.belief.pose = reading.pose or reading.frame_pose
            self._tell_sight(reading.t)
        elif reading.pose is not None:
            self.belief.update(None, reading.pose)
        if reading.sonar is not None and reading.sonar_pose is not None:
            self.belief.map.hear(reading.sonar, reading.sonar_pose, reading.sonar_attitude)
        if not self.safety.driving:
            return self._stand(reading.t)
        self._tell_blind(reading.blind)
        self._tell_deaf(reading.deaf)
        if self._stood:
            self._stood = False
            self.driver.reset()
            self.trigger.new_goal()  # to be held is not to be stuck
        command = self._steer(reading.t, self.belief.pose, reading.velocity)
        return (0.0, 0.0) if reading.overdue else command

    def instruct(self, words: str, by: str) -> bool:
        """Change the instruction of a mission in words from the next tick on; from any thread.

        A question that is open is withdrawn, and the next one, which carries the new words, asked at once.

        Raises:
            InputError: It is empty or too long.
        """
        if not isinstance(self.planner, MissionPlanner):
            return False
        self._told = checked_words(words, by), by
        return True

    def _take_words(self) -> None:
        """Take over an instruction that was changed: ask again, even where the survey had ended."""
        if self._told is None or not isinstance(self.planner, MissionPlanner):
            return
        (words, by), self._told = self._told, None
        self.planner.instruct(words)
        self._emit("instruction", text=words, by=by)
        self._unasked = True
        self._withdraw()
        self._ended = False

    def _withdraw(self) -> None:
        """Withdraw an open question."""
        self.clock.withdraw()
        self._collect()

    def go_home(self, x: float, y: float) -> None:
        """Drive to a point (m) around what is on the map, and ask nothing more."""
        self._withdraw()
        self.homing, self.end_reason = True, ""
        self.goals.go_home(x, y, self._now)

    def unwind(self, turns: float) -> bool:
        """Begin to turn on the spot against turns of the tether, positive to the left; False while it turns already.

        The hull is a circle: wherever the vehicle fits, it can turn.
        """
        if self._look_round.turning:
            return False
        self._look_round.turn(-2.0 * math.pi * turns)
        return True

    def stop(self, reason: str) -> None:
        """End the survey."""
        self.belief.tracker.settle()
        self.safety.states.move(self._now, Mover.MISSION, "end", reason)

    def _stand(self, t: float) -> Command:
        """Stand still; an open question stays open."""
        self._stood, self.plan = True, None
        self._advance(t)
        return 0.0, 0.0

    def _advance(self, t: float) -> None:
        """Advance the clock of the questions, and take over what has been decided."""
        self._now = t
        self.clock.advance(t)
        self._collect()

    def _steer(self, t: float, pose: Pose, velocity: Velocity) -> Command:
        """Decide when it matters and plan the next command, at time `t` (s)."""
        if self.belief.goal is None:
            self._began = t
            self.goals.begin(pose, t)
        self._advance(t)
        if self._ended and not self.route.goals:
            self.end_reason = SURVEY_ENDED
        if (turn := self._look_round.command()) is not None and not (self._blind or self.homing):
            self.trigger.new_goal()  # to look round is not to be stuck
            return turn
        if self.planner.cfg.route.ahead and self.route.update(t):
            self.trigger.new_goal()
        self._route(t)
        if not self._blind:
            self._watch(t, math.hypot(velocity[0], velocity[1]))
            self._route(t)
        assert self.field is not None
        slow = math.hypot(velocity[0], velocity[1]) < self.cfg.blind_speed_m_s
        if slow and not (self._blind or self.homing) and (turn_rad := self.route.turn_rad(self.field)):
            self.trigger.new_goal()  # nor is to turn
            return 0.0, math.copysign(YAW_RATE_RAD_S, turn_rad)
        cells = self.belief.map
        if self._blind:
            distance = self.belief.distance_in_known_water(self.cfg.local_m, self.cfg.passed_m)
        else:
            distance = cells.distance_near(pose.x, pose.y, self.cfg.local_m)
        self.plan = self.driver.plan(VehicleState(*pose, *velocity), self.field, distance, cell_m=cells.cfg.cell_m)
        if not self._blind:
            self.trigger.planner(self.plan.ok)
        if not self.plan.ok and not self._blind:
            self._emit("planner_failure", reason=self.plan.failure)
        if self.cfg.synchronous and self.pending:
            return 0.0, 0.0
        return self._slowed(self.plan.command)

    def _slowed(self, command: Command) -> Command:
        """Return a command at no more than the speed of a blind vehicle, on the same arc."""
        share = min(1.0, self.cfg.blind_speed_m_s / max(abs(command[0]), 1e-9)) if self._blind else 1.0
        return share * command[0], share * command[1]

    def _tell_blind(self, reason: str) -> None:
        """Note whether the sonar alone shows the way: then the goals at hand are finished, and nothing is decided.

        The vehicle then drives only where camera or sonar have found free water, and stands where that ends.
        """
        if bool(reason) == self._blind:
            return
        self._blind = bool(reason)
        self._emit("blind", blind=self._blind, reason=reason)
        self.trigger.new_goal()  # to wait for the camera is not to be stuck

    def _tell_deaf(self, reason: str) -> None:
        """Note whether the sonar is silent while the camera shows the way."""
        if bool(reason) != self._deaf:
            self._deaf = bool(reason)
            self._emit("deaf", deaf=self._deaf, reason=reason)

    def _tell_sight(self, t: float) -> None:
        """Note how far eyes that doubt tell oysters from sea floor: beyond that, nothing counts as explored."""
        (told_s, told_m), cells = self._sight, self.belief.map
        if cells.estimated and t - told_s >= SIGHT_TOLD_S and not abs(cells.sees_m - told_m) < SIGHT_TOLD_M:
            self._sight = t, cells.sees_m
            self._emit("sight", reach_m=round(cells.sees_m, 2))

    @property
    def pending(self) -> bool:
        """Whether a decision is under way."""
        return self.consultation.pending

    def _watch(self, t: float, speed: float) -> None:
        """Ask the advisor when Eq. 12 says so; log every change of its verdict."""
        if self.homing or self._ended:
            return
        if self.cfg.synchronous and t < self._acting_until - 1e-9:
            return
        if self.planner.cfg.route.ahead and not self._decided and t < self._began + self.cfg.first_s - 1e-9:
            return
        pose = self.belief.pose
        target = self.belief.goal if self._decided else None
        ahead = self.planner.cfg.route.ahead
        soon = self._asks_ahead() if ahead else None
        if ahead and not self.route.goals:
            self.trigger.new_goal()  # to wait for an answer is not to be stuck
        firing = self.trigger.update(t, pose.x, pose.y, speed, target, self.pending, soon)
        if firing is not None and self._unasked and firing.cause == "distance":
            firing = dataclasses.replace(firing, cause="instruction")  # only the change has brought it on
        if firing is not None and firing != self._last_firing:
            self._emit("trigger", cause=firing.cause, fired=firing.fired, held_by=firing.held_by)
        self._last_firing = firing
        if firing is not None and firing.held_by == "pending" and firing.cause in ("failure", "deviation"):
            self._withdraw()  # the open question shows a path that has since proved blocked
        if firing is None or not firing.fired:
            return
        if firing.cause in ("stuck", "failure", "deviation") and not self.end_reason:
            self.belief.goal_failed(FAILURES[firing.cause])
            self.route.drop(t)
        self.end_reason = ""
        self.trigger.asked(t, waits=not (ahead and self.route.goals))
        self._unasked = False
        self._known |= {track.index for track in self.belief.tracks}
        self.consultation.ask()
        self._collect()

    def _asks_ahead(self) -> bool:
        """Check whether the goals will be done before an answer can come, or there is a new cluster or instruction."""
        news = any(track.index not in self._known for track in self.belief.unvisited())
        if self.route.looking:  # what is looked at is in the pictures only when the robot is there
            return self._unasked
        return news or self._unasked or self.route.to_go_s(self.field) <= self.route.lead_s

    def _collect(self) -> None:
        """Take over a decision that has ended."""
        decided = self.consultation.take()
        if decided is None:
            return
        self.belief.last_failure = None
        asked = decided.asked
        if asked is not None and asked.finished:
            step = self._look_round.step(self._nothing_left)
            if step is None:
                self.end_reason = NOTHING_LEFT
            else:
                self._emit("doubt", look=step)
        elif asked is not None and asked.alone is not None:
            self.goals.explore(asked, asked.alone)
        elif decided.failure and decided.failure != "withdrawn":
            self._fall_back(decided)
            if self.pending:
                return
        elif decided.answer is not None and asked is not None:
            self._adopt(decided, asked)
        self._decided = True
        self._acting_until = self.clock.now() + self.cfg.action_s

    def _nothing_left(self, belief: Belief) -> bool:
        """Check whether nothing would be left on another map."""
        return self.planner.ask(dataclasses.replace(self.planner.outlook(self.field), belief=belief)).finished

    def _fall_back(self, decided: Decided) -> None:
        """Apply the named policy after the advisor was silent or wrong past its budget; after the rules, hold."""
        if decided.by_rules:
            self.goals.hold(decided.number, decided.failure)
            return
        self._emit("fallback", policy=self.cfg.fallback, failure=decided.failure, decision=decided.number)
        if self.cfg.fallback == "fail":
            self.end_reason = failed(decided.failure)
        elif self.cfg.fallback == "hold":
            self.goals.hold(decided.number, decided.failure)
        else:
            self.consultation.ask_rules()
            self._collect()

    def _adopt(self, decided: Decided, asked: AskedState) -> None:
        """Drive to what was chosen, or end the survey."""
        if not getattr(decided.answer, "end_survey", False):
            self.goals.adopt(decided, asked)
            return
        self._ended = True
        self.end_reason = "" if self.goals.end(decided, asked, self._now) else SURVEY_ENDED

    def _route(self, t: float) -> None:
        """Update the cost-to-go and the reference path; detect when the path was left."""
        belief, monitor = self.belief, self.monitor
        if self.cost_to_go.update(t) and self.field is not None:
            monitor.follow(self.field.path_from(belief.pose.x, belief.pose.y), new_goal=True)
        if self.field is not None and monitor.left_path(belief.pose.x, belief.pose.y):
            if monitor.exhausted:
                self.trigger.deviation()
                return
            self._emit("monitor", deviation_m=round(monitor.deviation(belief.pose.x, belief.pose.y), 3))
            monitor.follow(self.field.path_from(belief.pose.x, belief.pose.y), new_goal=False)
