"""Who decides whether the vehicle drives: the operator's words, its limits, and the person at the joystick."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from coral.reef.sea.link import VehicleReport
from coral.reef.sea.operator import Order, VehicleOrders, Word
from coral.reef.sea.safety import Breach, SafetyMonitor
from coral.reef.vehicle.states import Mover, PilotState, StateMachine
from coral.reef.world.geometry import Pose

RETRY_S = 1.0
"""An order that was refused is given again after this time."""
SURFACE_M = 0.3
"""At this depth the vehicle counts as surfaced."""
ASCENT_S = 300.0
"""A vehicle that has not come up by then is left to its autopilot."""
HOME_M = 1.0
"""So near to the start (m) the way back ends."""

_VEHICLE, _OPERATOR = Mover.VEHICLE, Mover.OPERATOR


class Supervisor:
    """Moves the vehicle's states and gives the orders that belong to them, once per control tick."""

    def __init__(
        self,
        states: StateMachine,
        orders: VehicleOrders,
        safety: SafetyMonitor,
        tell: Callable[..., None],
        go_home: Callable[[], None],
    ) -> None:
        """Set up; tell(event, **fields) records an event, go_home() makes the pilot drive back to the start."""
        self.states, self.orders, self.safety = states, orders, safety
        self.end_reason = ""
        """Why the survey is over, or ""."""
        self.returning = ""
        """Why the vehicle is on its way back, or ""."""
        self._tell, self._go_home = tell, go_home
        self._breach: Breach | None = None
        self._clear_since: float | None = None
        self._go_on: tuple[Mover, str] | None = None
        """The change of state that waits until the vehicle has taken the order to drive."""
        self._retry: tuple[Order, float] | None = None
        self._held = False

    @property
    def sends_commands(self) -> bool:
        """Whether set-points go to the vehicle: the pilot's, or zero until the autopilot itself holds."""
        state = self.states.state
        return state in (PilotState.READY, PilotState.SURVEYING) or (state is PilotState.HOLDING and not self._held)

    def awaits(self, recover_s: float, surface_after_s: float | None) -> str:
        """Return what would end the present state, in words; "" for surveying, which every limit ends.

        Sensors must be good for `recover_s`; after `surface_after_s` without them it comes up (s), None for never.
        """
        if self.returning and self.states.state is PilotState.SURVEYING:
            return f"on the way back, because of {self.returning}; ends within {HOME_M:g} m of the start"
        state, by = self.states.state, self.states.by
        if state is PilotState.READY:
            return "begins when every sensor has delivered something good"
        if state is PilotState.HOLDING and by is Mover.GUARD:
            after = "" if surface_after_s is None else f"; surfaces after {surface_after_s:.0f} s"
            return f"continues when all sensors have been good for {recover_s:g} s{after}, or on your word"
        if state is PilotState.HOLDING and by is _VEHICLE and self._breach is not None and self._breach.passing:
            return f"continues when the cause has been gone for {self.safety.cfg.settle_s:g} s, or on your word"
        if state is PilotState.HOLDING:
            return "continues only on your word"
        if state is PilotState.SURFACING:
            return "ends at the surface"
        return "continues only on your word, when the vehicle is given back" if state is PilotState.TAKEN_OVER else ""

    def update(
        self, now: float, t: float, report: VehicleReport, pose: Pose | None, words: Iterable[tuple[Word, str]]
    ) -> None:
        """Take in what happened in one tick, `now` by the monotonic clock, `t` since the survey began (s)."""
        self._hear_orders(t)
        self._notice_person(t, report)
        for word, source in words:
            self._obey(t, report, word, source)
        self._keep_limits(now, t, report, pose)
        self._retry_order(t)
        self._follow_state(t, report, pose)

    def complete(self, t: float, reason: str) -> None:
        """End a survey that has done all it could, as configured."""
        action = self.safety.cfg.on_done
        if action == "return" and self.states.state is PilotState.SURVEYING:
            self._return(reason)
        elif action == "surface" and self.states.move(t, Mover.VEHICLE, "must surface", reason):
            self._order("surface")
        elif self.states.state is not PilotState.SURFACING:
            self.end_reason = self.end_reason or reason

    def finish(self) -> None:
        """Leave the vehicle holding, unless it comes up, is steered by a person, or stands on the operator's deck."""
        if self.states.state not in (PilotState.SURFACING, PilotState.TAKEN_OVER) and not self._held:
            self._order("hold")

    def _order(self, order: Order) -> None:
        self._retry, self._held = None, False
        self._tell("order", order=order)
        self.orders.give(order)

    def _hear_orders(self, t: float) -> None:
        for result in self.orders.results():
            if result.refusal:
                self._tell("order_refused", order=result.order, reason=result.refusal)
                if result.order in ("hold", "surface"):
                    self._retry = (result.order, t + RETRY_S)
                elif result.order == "arm":
                    self._go_on = None
                continue
            self._held = result.order == "hold"
            if result.order == "arm" and self._go_on is not None:
                (who, cause), self._go_on = self._go_on, None
                self.states.move(t, who, cause)
                self._breach = None

    def _notice_person(self, t: float, report: VehicleReport) -> None:
        """Give way to a person at the joystick, or one who has disarmed the vehicle."""
        if self.orders.pending == "arm" or self.states.state in (PilotState.TAKEN_OVER, PilotState.STOPPED):
            return
        if report.manual_override:
            self.states.move(t, _OPERATOR, "take over", f"taken over in mode {report.mode or 'unknown'}")
        elif not report.armed and self.states.state is not PilotState.READY and math.isfinite(report.heartbeat_age_s):
            self.states.move(t, _OPERATOR, "take over", "disarmed, not by this program")

    def _obey(self, t: float, report: VehicleReport, word: Word, source: str) -> None:
        self._tell("operator", word=word, source=source)
        by = f"by the operator ({source})"
        if word == "hold":
            if self.states.move(t, _OPERATOR, "hold", f"held {by}"):
                self._go_on = None
                self._order("hold")
        elif word == "resume":
            self._resume(report)
        elif word == "home":
            if self.states.state in (PilotState.SURVEYING, PilotState.HOLDING, PilotState.TAKEN_OVER):
                self._return(f"the operator's word ({source})")
                self._resume(report)
        elif word == "surface":
            if self.states.move(t, _OPERATOR, "surface", f"ended {by}"):
                self._order("surface")
        elif word == "disarm":
            self.end_reason = self.end_reason or f"disarmed {by}"
            self._held = True  # no order to hold after it
            self.orders.give("disarm")
        elif word == "stop":
            self.end_reason = self.end_reason or f"stopped {by}"

    def _resume(self, report: VehicleReport) -> None:
        """Continue after a hold, or after a person has steered; with what has happened so far."""
        if self.states.state in (PilotState.HOLDING, PilotState.TAKEN_OVER):
            self.safety.go_on(report)
            self._go_on = (_OPERATOR, "go on")
            self._order("arm")

    def _return(self, reason: str) -> None:
        """Go back to the start, unless it is on its way."""
        if not self.returning:
            self.returning = reason
            self._go_home()

    def _keep_limits(self, now: float, t: float, report: VehicleReport, pose: Pose | None) -> None:
        state = self.states.state
        if state in (PilotState.TAKEN_OVER, PilotState.STOPPED, PilotState.SURFACING):
            return
        if t >= self.safety.time_limit_s and not (self.returning and state is PilotState.SURVEYING):
            self.end_reason = self.end_reason or "time limit"
        breach = self.safety.check(now, t, report, pose)
        if breach is None:
            self._let_pass(t)
            return
        self._clear_since = None
        if breach.action == "return":
            self._begin_return(breach, state)
            return
        if self._breach is not None and self._breach.cause == breach.cause:
            self._go_on = None if self.states.by is _VEHICLE else self._go_on
            return
        self._breach = breach
        if breach.action == "surface" and self.states.move(t, _VEHICLE, "must surface", breach.reason):
            self._tell_breach(breach)
            self._order("surface")
        elif breach.action == "hold" and self.states.move(t, _VEHICLE, "fault", breach.reason):
            self._tell_breach(breach)
            self._order("hold")

    def _tell_breach(self, breach: Breach) -> None:
        self._tell("limit", cause=breach.cause, reason=breach.reason, action=breach.action)

    def _begin_return(self, breach: Breach, state: PilotState) -> None:
        if self.returning or state not in (PilotState.SURVEYING, PilotState.HOLDING):
            return
        self._tell_breach(breach)
        self._return(breach.reason)

    def _let_pass(self, t: float) -> None:
        """Continue after a passing breach, once it has been over for a while."""
        if self._breach is None or not self._breach.passing or self._go_on is not None:
            return
        if self.states.state is not PilotState.HOLDING or self.states.by is not _VEHICLE:
            self._breach = None
            return
        self._clear_since = t if self._clear_since is None else self._clear_since
        if t - self._clear_since >= self.safety.cfg.settle_s - 1e-9 and self.orders.pending is None:
            self._go_on = (_VEHICLE, "fault passed")
            self._clear_since = None
            self._order("arm")

    def _retry_order(self, t: float) -> None:
        if self._retry is not None and t >= self._retry[1] and self.orders.pending is None:
            order = self._retry[0]
            wanted = {PilotState.HOLDING: "hold", PilotState.SURFACING: "surface"}.get(self.states.state)
            self._retry = None
            if order == wanted:
                self.orders.give(order)

    def _follow_state(self, t: float, report: VehicleReport, pose: Pose | None) -> None:
        """Finish what a state began: an ascent that the guard asked for, the surface, the end of the way back."""
        states = self.states
        if states.state is PilotState.SURFACING:
            if states.by is Mover.GUARD and t - states.since_s < 0.05:
                self._order("surface")
            up = report.depth_m is not None and report.depth_m < SURFACE_M
            if up or t - states.since_s > ASCENT_S:
                reason = states.reason
                states.move(t, _VEHICLE, "at the surface", reason)
                self._held = True
                self.end_reason = f"surfaced: {reason}" if up else f"left to surface: {reason}"
        elif self.returning and states.state is PilotState.SURVEYING and pose is not None:
            home = self.safety.area.start
            if math.dist(pose[:2], home[:2]) < HOME_M:
                self._arrive(t)

    def _arrive(self, t: float) -> None:
        reason, self.returning = f"back at the start: {self.returning}", ""
        if self.safety.cfg.after_return == "surface" and self.states.move(t, _VEHICLE, "must surface", reason):
            self._order("surface")
        else:
            self.end_reason = reason
