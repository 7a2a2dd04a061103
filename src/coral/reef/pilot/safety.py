"""Whether the vehicle may drive: what the guard finds moves the vehicle from state to state, and is told."""

from __future__ import annotations

from collections.abc import Callable

from coral.reef.pilot.guard import Input, Reading, Refusal, SensorGuard
from coral.reef.vehicle.sensing import VehicleObservation
from coral.reef.vehicle.states import Mover, PilotState, StateMachine


class SafetyWatch:
    """Stops the vehicle when its sensors are lost, lets it continue when they are back, surfaces if they stay away.

    Every change of state is the event `state`; what is refused of an input is the event `sensor`, once for each reason,
    and once more when the input is good again.
    """

    def __init__(self, guard: SensorGuard, emit: Callable[..., None]) -> None:
        self.guard, self.states = guard, StateMachine(self._tell)
        self._emit = emit
        self._refused: dict[Input, Refusal] = {}
        self._good_since: float | None = None

    @property
    def driving(self) -> bool:
        """Whether the pilot may drive."""
        return self.states.state is PilotState.SURVEYING

    def update(self, seen: VehicleObservation) -> Reading:
        """Check an observation, and change the state accordingly."""
        reading = self.guard.check(seen)
        self._tell_sensors(reading)
        t, states, cfg = reading.t, self.states, self.guard.cfg
        if reading.lost:
            self._good_since = None
            if states.state is PilotState.READY:
                states.reason = f"waits: {reading.lost}"
            states.move(t, Mover.GUARD, "sensors lost", reading.lost)
        else:
            self._good_since = t if self._good_since is None else self._good_since
            if states.state is PilotState.READY:
                states.move(t, Mover.GUARD, "sensors good")
            elif t - self._good_since >= cfg.recover_s - 1e-9:
                states.move(t, Mover.GUARD, "sensors back")
        held = states.state is PilotState.HOLDING
        if held and cfg.surface_after_s is not None and t - states.since_s >= cfg.surface_after_s - 1e-9:
            states.move(t, Mover.GUARD, "held too long", f"held for {t - states.since_s:.0f} s: {states.reason}")
        return reading

    def _tell(self, source: PilotState, target: PilotState, cause: str, who: Mover, reason: str) -> None:
        self._emit("state", state=target.value, was=source.value, cause=cause, by=who.value, reason=reason)

    def _tell_sensors(self, reading: Reading) -> None:
        """Emit what has changed: a new reason of an input, or that it passes again."""
        now = {refusal.input: refusal for refusal in reading.refusals}
        for name, refusal in now.items():
            before = self._refused.get(name)
            if before is None or before.reason != refusal.reason:
                self._emit("sensor", input=name, refused=refusal.reason, detail=refusal.detail)
        for name in [name for name in self._refused if name not in now and not self.guard.is_refused(name)]:
            self._emit("sensor", input=name, refused="", detail="")
            del self._refused[name]
        self._refused |= now
