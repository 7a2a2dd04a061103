"""The robot's side of a mission, tick by tick: perceive, decide when it matters, drive always (paper Alg. 1)."""

from __future__ import annotations

import asyncio
import dataclasses
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from coral.advisor.attribution import Source, source_of, spent
from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.consult import Attempt, BudgetCfg, Outcome, consult
from coral.advisor.fallback import FOR_RUNS, Fallback, failed
from coral.advisor.question import Advisor, Question, Rejection
from coral.config import Count, NonNegative, Positive
from coral.reef.decide.asked import AskedState
from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.own_trigger import MakeTrigger
from coral.reef.decide.planner import HighLevelPlanner
from coral.reef.decide.route import Goal
from coral.reef.decide.trigger import Cause, Firing, SmartTrigger, TriggerCfg
from coral.reef.drive.controller import Plan
from coral.reef.drive.cost_to_go import CostToGo
from coral.reef.drive.local_planner import LocalPlanner
from coral.reef.drive.monitor import MonitorCfg, PathMonitor
from coral.reef.drive.traffic import Traffic, TrafficCfg
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.pilot.guard import GuardCfg, Reading, SensorGuard
from coral.reef.pilot.leftover import chain_of
from coral.reef.pilot.look_round import LookRound, LookRoundCfg
from coral.reef.pilot.safety import SafetyWatch
from coral.reef.vehicle.sensing import VehicleObservation, Velocity
from coral.reef.vehicle.states import Mover
from coral.reef.vehicle.vehicle import VehicleState
from coral.reef.world.geometry import Pose, to_world
from coral.reef.world.instruction import checked_words

Command = tuple[float, float]
"""Forward speed (m/s) and yaw rate (rad/s)."""
Emit = Callable[..., None]
"""emit(event, **fields) appends to the run's events."""

RULES_BUDGET = BudgetCfg(max_requeries=7)
"""Answers of the rules that are verified before a fallback gives up for this time."""

FAILURES: dict[Cause, str] = {
    "stuck": "the robot stood still on the way",
    "failure": "the controller found no way past obstacles",
    "deviation": "obstacles forced the robot off its path too often",
}
"""Why a goal was given up, in words for the next question."""

NOTHING_LEFT = "nothing left to explore"
SURVEY_ENDED = "the advisor ended the survey"
GONE = "the map shows no oysters there any more"


@dataclass(frozen=True, kw_only=True)
class PilotCfg:
    """How decisions are asked for and what happens without them."""

    trigger: TriggerCfg = field(default_factory=TriggerCfg)
    monitor: MonitorCfg = field(default_factory=MonitorCfg)
    fields: CostFieldCfg = field(default_factory=CostFieldCfg)
    traffic: TrafficCfg = field(default_factory=TrafficCfg)
    guard: GuardCfg = field(default_factory=GuardCfg)
    budget: BudgetCfg = field(default_factory=BudgetCfg)
    fallback: Fallback = FOR_RUNS
    """What happens when a decision was not reached within its budget: the rules decide, hold keeps the last goal and
    asks again, fail ends the mission. `coral reef bench` holds by default: there the advisor stands alone."""
    look_round: LookRoundCfg = field(default_factory=LookRoundCfg)
    synchronous: bool = False
    """Stand still while a question is open, then drive for `action_s`: DREAM's protocol (paper IV-E), a baseline."""
    action_s: float = 1.0
    initial_m: float = 2.0
    """The initial waypoint lies this far ahead of the start (Alg. 1)."""
    blind_m: float = 6.0
    """It may lie up to this far, so that the robot need not stand still until the first answer comes."""
    first_s: float = 1.0
    """The first question is asked this long after the start. Departs from the paper: a map of one picture shows too
    little."""
    local_m: float = 5.0
    """How far about itself the robot keeps its distances to obstacles up to date; beyond the sensing range."""
    cost_to_go: bool = True
    """False is the ablation "w/o cost-to-go": the controller is given the straight distance to the goal, whatever lies
    between, as a local planner alone would have it. Departs from the paper: it describes no cost-to-go."""
    blind_speed_m_s: Positive = 0.3
    """Speed without a camera, half the cruise speed: if the sonar is lost too, the vehicle stands within 1 s."""
    passed_m: Positive = 0.45
    """Without a camera, water within this distance of where the vehicle has been is free: it fitted there. The hull,
    the controller's margin and a cell."""
    field_period_s: float = 1.0
    """Shortest time between updates of the cost-to-go when only the map has changed."""
    field_cells: Count = 200_000
    """A cost-to-go that searches more cells than this (some 8 ms) is left to the preparation thread; the robot drives
    by the last one meanwhile. On maps of up to 44 m it never does."""
    prepare_s: NonNegative = 0.3
    """Simulated time in which a question, or such a cost-to-go, is prepared from the belief as it was at its
    beginning. A real vehicle gets it as soon as it is there."""


class AtOnce:
    """A clock on which advisors take no time: for rules that step in."""

    def __init__(self, clock: SimulatedClock | WallClock) -> None:
        self._clock = clock

    def now(self) -> float:
        """Return the time on the clock below (s)."""
        return self._clock.now()

    async def reply(self, asking: Callable[[], Any], timeout_s: float) -> Any:
        """Return the reply."""
        return await asking()


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
        numbers: Iterator[int] | None = None,
        trigger: MakeTrigger = SmartTrigger,
    ) -> None:
        """Set up a robot; `numbers` numbers its decisions, and robots that share a log share it too."""
        self.cfg = cfg or PilotCfg()
        self.belief, self.planner, self.driver = belief, planner, driver
        self.advisor, self.fallback, self.clock = advisor, fallback, clock
        self.route = planner.route
        self.trigger = trigger(self.cfg.trigger)
        self.monitor = PathMonitor(self.cfg.monitor)
        self.traffic = Traffic(self.cfg.traffic)
        self.cost_to_go = CostToGo(
            belief,
            clock,
            self.cfg.fields,
            period_s=self.cfg.field_period_s,
            most_cells=self.cfg.field_cells,
            prepare_s=self._prepare_s,
            straight=not self.cfg.cost_to_go,
        )
        layer = belief.map.layer
        guard = SensorGuard(
            belief.map.camera,
            belief.map.size_m,
            self.cfg.guard,
            None if layer is None else layer.sonar,
            sonar_alone=belief.map.cfg.obstacles == "sonar",
        )
        self.safety = SafetyWatch(guard, emit)
        """Checks the sensors; its `states` say what the vehicle is doing, and why."""
        self._look_round = LookRound(belief, self.cfg.look_round)
        self.plan: Plan | None = None
        self.open_question: Question[Any] | None = None
        self.last_attempt: Attempt | None = None
        self.end_reason = ""
        """Why this robot has nothing more to do; "" again when it is asked anew and there is something."""
        self.homing = False
        """Whether it is on its way home, for good."""
        self._emit, self._log = emit, log
        self._numbers = numbers or itertools.count()
        self._decision = 0
        self._decided = False
        self._attempts = 0
        self._task: asyncio.Task[Outcome[Any]] | None = None
        self._last_firing: Firing | None = None
        self._mode = ""
        self._known: set[int] = set()
        """Labels of the clusters that were on a map when a question was asked."""
        self._acting_until = self._began = self._asked_s = -math.inf
        self._now, self._stood = 0.0, False
        self._blind = self._deaf = False
        self._asked: AskedState | None = None
        """The last question, in whose state its answer is judged."""
        self._ended = False
        self._told: tuple[str, str] | None = None
        self._reasks = False
        """Whether the instruction was changed since the last question."""
        self._by_rules = False
        """Whether the decision under way is the fallback's."""

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
        elif reading.pose is not None:
            self.belief.update(None, reading.pose)
        if reading.sonar is not None and reading.sonar_pose is not None:
            self.belief.hear(reading.sonar, reading.sonar_pose, reading.sonar_attitude)
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

        Args:
            words: The new instruction.
            by: Who changed it, for the record.

        Returns:
            Whether there is an instruction to change.

        Raises:
            InputError: It is empty or too long.
        """
        if not isinstance(self.planner, MissionPlanner):
            return False
        self._told = checked_words(words, by), by
        return True

    def _take_words(self) -> None:
        """Take over an instruction that was changed."""
        if self._told is None or not isinstance(self.planner, MissionPlanner):
            return
        (words, by), self._told = self._told, None
        self.planner.instruct(words)
        self._emit("instruction", text=words, by=by)
        self.clock.withdraw()
        self._collect()
        self._reasks, self._ended = True, False

    def go_home(self, x: float, y: float) -> None:
        """Drive to a point (m) around what is on the map, and ask nothing more."""
        self.clock.withdraw()
        self._collect()
        self.homing, self.end_reason = True, ""
        self.route.follow([Goal(x=x, y=y)], self._now)
        self._emit("goal", x=x, y=y, source="home", decision=None, index=None, reason="the way home", violates=False)

    def stop(self, reason: str) -> None:
        """End the survey."""
        self.safety.states.move(self._now, Mover.MISSION, "end", reason)

    def _stand(self, t: float) -> Command:
        """Stand still; an open question stays open."""
        self._stood, self.plan = True, None
        self._advance(t)
        return 0.0, 0.0

    def _advance(self, t: float) -> None:
        """Advance the clock of the questions, and take over what has been decided."""
        self._now = t
        self.clock.advance(t) if isinstance(self.clock, SimulatedClock) else self.clock.advance()
        self._collect()

    def _steer(self, t: float, pose: Pose, velocity: Velocity) -> Command:
        """Decide when it matters and plan the next command, at time `t` (s)."""
        if self.belief.goal is None:
            self._began = t
            x, y = self._initial(pose)
            self.route.follow([Goal(x=x, y=y)], t)
            self._emit(
                "goal",
                x=x,
                y=y,
                source="initial",
                decision=None,
                index=None,
                reason="initial waypoint",
                violates=False,
            )
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
        cells = self.belief.map
        if self._blind:
            distance = self.belief.distance_in_known_water(self.cfg.local_m, self.cfg.passed_m)
        else:
            distance = cells.distance_near(pose.x, pose.y, self.cfg.local_m)
        if self.belief.others:
            distance = self.traffic.stamped(distance, cells.cfg.cell_m, pose, self.belief.others)
        self.plan = self.driver.plan(VehicleState(*pose, *velocity), self.field, distance, cell_m=cells.cfg.cell_m)
        if not self._blind:
            self.trigger.planner(self.plan.ok)
        if not self.plan.ok and not self._blind:
            self._emit("planner_failure", reason=self.plan.failure)
        if self.cfg.synchronous and self.pending:
            return 0.0, 0.0
        return self.traffic.held(self._slowed(self.plan.command), pose, self.belief.others)

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

    def _initial(self, pose: Pose) -> tuple[float, float]:
        """Return the initial waypoint: far enough ahead to drive while the first answer is awaited."""
        way_m = self.cfg.initial_m
        if self.planner.cfg.route.ahead and not self.belief.others:  # robots that start abreast soon need to part
            way_m = max(way_m, min(self.route.lead_s * self.planner.cfg.route.cruise_m_s, self.cfg.blind_m))
        while way_m > self.cfg.initial_m and not self.belief.map.contains(*to_world(pose, way_m, 0.0), margin_m=1.0):
            way_m -= 0.5
        return to_world(pose, way_m, 0.0)

    @property
    def pending(self) -> bool:
        """Whether a decision is under way."""
        return self._task is not None

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
        if firing is not None and firing.cause == "distance" and self._reasks:
            firing = dataclasses.replace(firing, cause="instruction")
        if firing is not None and firing != self._last_firing:
            self._emit("trigger", cause=firing.cause, fired=firing.fired, held_by=firing.held_by)
        self._last_firing = firing
        if firing is not None and firing.held_by == "pending" and firing.cause in ("failure", "deviation"):
            self.clock.withdraw()  # the open question shows a path that has since proved blocked
            self._collect()
        if firing is None or not firing.fired:
            return
        if firing.cause in ("stuck", "failure", "deviation") and not self.end_reason:
            self.belief.goal_failed(FAILURES[firing.cause])
            self.route.drop(t)
        self.end_reason = ""
        self.trigger.asked(t, waits=not (ahead and self.route.goals))
        self._attempts, self._decision, self._reasks = 0, next(self._numbers), False
        self._known |= {track.index for track in self.belief.tracks}
        self._task = self.clock.start(
            consult(
                self.advisor,
                self._observe,
                self._verify,
                self.cfg.budget,
                self.clock,
                self._attempted,
                self._decision,
            )
        )
        self._collect()

    def _asks_ahead(self) -> bool:
        """Check whether the goals will be done before an answer can come, or there is a new cluster or instruction."""
        news = any(track.index not in self._known for track in self.belief.unvisited())
        return (news and not self.route.looking) or self._reasks or self.route.to_go_s(self.field) <= self.route.lead_s

    async def _observe(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Have the next question prepared, from the belief as it is now."""
        self._asked_s = self.clock.now()
        for guess in self.planner.settle():
            self._emit("guess", **dataclasses.asdict(guess))
        asked = await self._prepare(rejections)
        question = self.open_question = asked.question
        if question is None:
            return None
        if asked.mode != self._mode:
            self._mode = asked.mode
            self._emit("mode", mode=self._mode)
        self._emit(
            "question",
            decision=self._decision,
            attempt=self._attempts,
            mode=self._mode,
            acceptable=asked.acceptable,
            pictures=[p.digest for p in question.pictures],
            centroids=chain_of(asked.outlook.belief, asked.outlook.closed),
        )
        self._attempts += 1
        return question

    async def _prepare(self, rejections: Sequence[Rejection]) -> AskedState:
        """Make the next question on another thread, from a snapshot of the belief as it is now."""
        outlook, reasons = self.planner.outlook(self.field), list(rejections)
        self._asked = await self.clock.prepare(lambda: self.planner.ask(outlook, reasons), self._prepare_s)
        return self._asked

    def _verify(self, question: Question[Any], answer: Any) -> Rejection | None:
        """Check an answer to the last question."""
        assert self._asked is not None
        return self.planner.verify(self._asked, answer)

    @property
    def _prepare_s(self) -> float:
        """How long a question takes to prepare, in simulated time (s)."""
        return 0.0 if self.cfg.synchronous else self.cfg.prepare_s

    def _attempted(self, attempt: Attempt) -> None:
        refusal = attempt.rejection
        self._emit(
            "verdict",
            decision=attempt.decision,
            attempt=attempt.attempt,
            verdict=attempt.verdict,
            code=refusal.code if refusal else "",
            reason=refusal.reason if refusal else "",
            answer=attempt.answer,
            asked_at=round(attempt.asked_at_s, 3),
            **dataclasses.asdict(spent(attempt)),
            **({"faults": list(attempt.usage.faults)} if attempt.usage.faults else {}),
        )
        self.last_attempt = attempt
        if attempt.verdict in ("accepted", "rejected", "malformed"):
            self.route.answered(attempt.answered_at_s - self._asked_s)
        self._log(attempt)

    def _collect(self) -> None:
        """Take over a finished decision."""
        if self._task is None or not self._task.done():
            return
        outcome, self._task, self.open_question = self._task.result(), None, None
        by_rules, self._by_rules = self._by_rules, False
        self.belief.last_failure = None
        asked = self._asked
        if asked is not None and asked.finished:
            step = self._look_round.step(self._nothing_left)
            if step is None:
                self.end_reason = NOTHING_LEFT
            else:
                self._emit("doubt", step=step)
        elif asked is not None and asked.alone is not None:
            self._explore(asked, asked.alone)
        elif by_rules and outcome.failure not in ("", "withdrawn"):
            self._hold(outcome.failure)
        elif outcome.failure and outcome.failure != "withdrawn":
            self._fall_back(outcome)
            if self._task is not None:
                return
        elif outcome.answer is not None and asked is not None:
            self._adopt(asked, outcome.answer, "fallback" if by_rules else source_of(self.advisor))
        self._decided = True
        self._acting_until = self.clock.now() + self.cfg.action_s

    def _nothing_left(self, belief: Belief) -> bool:
        """Check whether nothing would be left on another map."""
        return self.planner.ask(dataclasses.replace(self.planner.outlook(self.field), belief=belief)).finished

    def _fall_back(self, outcome: Outcome[Any]) -> None:
        """Apply the named policy after the advisor was silent or wrong past its budget."""
        self._emit("fallback", policy=self.cfg.fallback, failure=outcome.failure, decision=self._decision)
        if self.cfg.fallback == "fail":
            self.end_reason = failed(outcome.failure)
        elif self.cfg.fallback == "hold":
            self._hold(outcome.failure)
        else:
            self._by_rules = True
            self._task = self.clock.start(
                consult(
                    self.fallback, self._observe_alone, self._verify, RULES_BUDGET, AtOnce(self.clock), lambda _: None
                )
            )
            self._collect()

    async def _observe_alone(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Have a question prepared for the rules: no question to the advisor, so none in its record."""
        return (await self._prepare(rejections)).question

    def _hold(self, reason: str) -> None:
        """Keep the present goal, which also is a decision, and not the advisor's."""
        self._emit("held", source="fallback", decision=self._decision, reason=reason)

    def _heard(self, asked: AskedState, answer: Any) -> dict[str, Any]:
        """Keep what an answer in a mission in words says of things, where no goal comes of it."""
        pose = asked.outlook.arrival.pose
        return self.planner.adopt(asked, answer, Goal(x=pose.x, y=pose.y)) if hasattr(answer, "answer") else {}

    def _adopt(self, asked: AskedState, answer: Any, source: Source) -> None:
        """Put a decision behind the goals that were under way when it was asked for; without `ahead` there are none."""
        if getattr(answer, "end_survey", False):
            said = {"answer": answer.answer, **self._heard(asked, answer)} if hasattr(answer, "answer") else {}
            # A mission in words ends where the robot was to be when the answer was needed.
            arrival = asked.outlook.arrival
            before = [g for g in self.route.goals if g in arrival.goals]
            way = [*before, Goal(x=arrival.pose.x, y=arrival.pose.y)] if said and arrival.in_s > 0.0 else []
            self.end_reason, self._ended = "" if way else SURVEY_ENDED, True
            if way:
                self.route.follow(way, self._now)
            self._emit("held", source=source, decision=self._decision, reason=SURVEY_ENDED, **said)
            return
        if source == "fallback" and getattr(answer, "explore_rest", False):
            answer = answer.model_copy(update={"explore_rest": False})  # it stands in for one answer, not for the rest
        goal = self.planner.locate(asked, answer)
        if goal is None or isinstance(goal, Rejection):
            label = getattr(answer, "selected_centroid_index", getattr(answer, "dot", None))
            self.belief.last_failure = (label, GONE)
            reason = f"dot {label}: {GONE}"
            self._emit("held", source=source, decision=self._decision, reason=reason, **self._heard(asked, answer))
            return
        onward = self.planner.onward(asked, answer)
        before = [g for g in self.route.goals if g in asked.outlook.arrival.goals]
        if not before:
            self.trigger.new_goal()
        self.route.follow([*before, goal, *onward], self.clock.now())
        self._emit(
            "goal",
            x=round(goal.x, 3),
            y=round(goal.y, 3),
            source=source,
            decision=self._decision,
            index=goal.index,
            reason=getattr(answer, "reason", ""),
            **self.planner.adopt(asked, answer, goal),
            **({"overtaken": True} if self._overtaken(goal) else {}),
            **({"waits": len(before)} if before else {}),
            **(
                {"then": [g.index if g.index is not None else [round(g.x, 3), round(g.y, 3)] for g in onward]}
                if onward
                else {}
            ),
        )

    def _explore(self, asked: AskedState, goal: Goal) -> None:
        """Go on to the next unexplored place of the robot's own tour, as the advisor has said."""
        before = [g for g in self.route.goals if g in asked.outlook.arrival.goals]
        if not before:
            self.trigger.new_goal()
        self.route.follow([*before, goal], self.clock.now())
        self._emit(
            "goal",
            x=round(goal.x, 3),
            y=round(goal.y, 3),
            source="tour",
            decision=None,
            index=None,
            reason="unexplored water comes next in the robot's own tour, to which the advisor left the rest",
            violates=False,
            centroids=chain_of(asked.outlook.belief),
            **({"waits": len(before)} if before else {}),
        )

    def _overtaken(self, goal: Goal) -> bool:
        """Check whether the robot has seen the chosen cluster from near while the answer was awaited."""
        track = self.belief.track(goal.index)
        return track is not None and track.visited

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
