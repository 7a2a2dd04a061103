"""A trigger whose function decides when the advisor is asked, in place of the distance to the goal in Eq. 12."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from coral.errors import InputError
from coral.plugins import named_plugin
from coral.reef.decide.trigger import Firing, SmartTrigger, TriggerCfg


class Trigger(Protocol):
    """Interface of a trigger; `SmartTrigger` says what each method means."""

    def planner(self, ok: bool) -> None:
        """Handle whether the low-level planner found a way."""
        ...

    def deviation(self) -> None:
        """Handle that the robot cannot follow its path."""
        ...

    def asked(self, t: float, *, waits: bool = True) -> None:
        """Handle that the advisor is asked now."""
        ...

    def new_goal(self) -> None:
        """Handle a new goal."""
        ...

    def update(
        self,
        t: float,
        x: float,
        y: float,
        speed: float,
        target: tuple[float, float] | None,
        pending: bool,
        soon: bool | None = None,
    ) -> Firing | None:
        """Return the predicate that holds now, if any."""
        ...


@dataclass(frozen=True, kw_only=True)
class TriggerMoment:
    """What a trigger's function sees: the robot's own estimates at one control tick."""

    t: float
    """Simulated time (s)."""
    x: float
    """Estimated position (m, world)."""
    y: float
    """Estimated position (m, world)."""
    speed: float
    """Speed (m/s)."""
    target: tuple[float, float] | None
    """Active goal (m, world)."""
    soon: bool | None
    """Whether the goals will be done before an answer can come; None if the variant does not ask ahead."""
    since_asked_s: float
    """Time since the last question (s); infinite before the first."""


Wanted = Callable[[TriggerMoment], bool]
MakeTrigger = Callable[[TriggerCfg], Trigger]


class FunctionTrigger(SmartTrigger):
    """Asks when a function says so, and as `SmartTrigger` does when the robot is stuck, blocked or has no goal.

    The cooldown and the rule of one open question at a time hold for the function too.
    """

    def __init__(self, wanted: Wanted, cfg: TriggerCfg | None = None) -> None:
        super().__init__(replace(cfg or TriggerCfg(), always=False))
        self._wanted = wanted

    def update(
        self,
        t: float,
        x: float,
        y: float,
        speed: float,
        target: tuple[float, float] | None,
        pending: bool,
        soon: bool | None = None,
    ) -> Firing | None:
        """See `Trigger.update`; the function's wish has the cause "own"."""
        now = TriggerMoment(t=t, x=x, y=y, speed=speed, target=target, soon=soon, since_asked_s=t - self._last_query)
        firing = super().update(t, x, y, speed, target, pending, bool(self._wanted(now)))
        return replace(firing, cause="own") if firing is not None and firing.cause == "distance" else firing


def trigger_maker(trigger: MakeTrigger | Wanted | str, where: str = "--trigger") -> MakeTrigger:
    """Return the function that makes a robot's trigger.

    Args:
        trigger: Name of an entry point of the group `coral.triggers`, a function of a `TriggerCfg` that is a class or
            marked by the attribute `makes_trigger`, or a function of a `TriggerMoment` that returns whether to ask.
        where: Flag or argument, for the error.

    Raises:
        InputError: There is no such entry point, or what it names cannot be called.
    """
    given: Any = trigger
    if isinstance(given, str):
        given = named_plugin("coral.triggers", given, where)
    if not callable(given):
        raise InputError(
            where, "", repr(given), "a function of a TriggerMoment, or a class with the methods of Trigger"
        )
    if isinstance(given, type) or getattr(given, "makes_trigger", False):
        return given  # type: ignore[no-any-return]
    wanted: Wanted = given
    return lambda cfg: FunctionTrigger(wanted, cfg)
