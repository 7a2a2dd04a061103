"""The smart trigger: when the advisor is worth asking (paper III-F, Eq. 12)."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Literal

from coral.reef.decide.own_parts import TriggerMoment, Wanted

Cause = Literal["first", "distance", "stuck", "failure", "deviation", "own", "instruction"]
"""Predicates of Eq. 12; "own" is that of a trigger brought by the user, "instruction" that a person changed it."""


@dataclass(frozen=True, kw_only=True)
class TriggerCfg:
    """Thresholds of Eq. 12 (paper IV-F unless noted)."""

    distance_m: float = 2.5
    """Distance to the goal at which the advisor is asked for the next one; D_trig."""
    stuck_move_m: float = 0.1
    """Delta p_stuck, over the whole of `stuck_time_s`."""
    stuck_speed_m_s: float = 0.1
    """v_stuck."""
    stuck_time_s: float = 20.0
    """T_stuck."""
    max_failures: int = 2
    """N_fail_max, consecutive planner failures."""
    cooldown_s: float = 5.0
    """T_cooldown. Departs from the paper: it says 50 s, but its 54.7 calls per 321 s environment are one per 5.9 s; 50
    control ticks of 0.1 s fit both."""
    always: bool = False
    """Ask at every cooldown, whatever Eq. 12 says (ablation "w/o smart trigger")."""


@dataclass(frozen=True, kw_only=True)
class Firing:
    """A trigger predicate became true: its cause, and what held it back ("" when the advisor is asked)."""

    cause: Cause
    held_by: Literal["", "cooldown", "pending"]

    @property
    def fired(self) -> bool:
        """Whether the advisor is asked now."""
        return not self.held_by


class SmartTrigger:
    """Decides when to ask the advisor.

    With a function of the user's own it asks when that says so, and by Eq. 12 when the robot is stuck, blocked or has
    no goal. The cooldown and the rule of one open question at a time hold for the function too.
    """

    def __init__(self, cfg: TriggerCfg | None = None, wanted: Wanted | None = None) -> None:
        self.cfg, self._wanted = cfg or TriggerCfg(), wanted
        self._history: deque[tuple[float, float, float]] = deque()
        self._slow_since: float | None = None
        self._last_query = -math.inf
        self._failures = 0
        self._deviated = False

    def planner(self, ok: bool) -> None:
        """Count consecutive failures of the low-level planner."""
        self._failures = 0 if ok else self._failures + 1

    def deviation(self) -> None:
        """Record that the path feasibility monitor gave up on the current waypoint."""
        self._deviated = True

    def asked(self, t: float, *, waits: bool = True) -> None:
        """Start the cooldown; if the robot `waits` for the answer, clear the counters."""
        self._last_query = t
        if waits:
            self.new_goal()

    def new_goal(self) -> None:
        """Restart the progress check: waiting for the answer does not count as being stuck."""
        self._failures = 0
        self._deviated = False
        self._history.clear()
        self._slow_since = None

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
        """Evaluate Eq. 12 at time `t` (s) for the robot at (x, y) (m), on its way to `target` at `speed` (m/s).

        `pending`: a question is already open. `soon`: whether the goals will be done before an answer can come; None:
        ask by distance, as the paper does.

        Returns:
            The predicate that holds now, if any; stuck before failure before distance.
        """
        cfg = self.cfg
        stuck = self._stuck(t, x, y, speed)
        since_s = t - self._last_query
        wished = self._wanted is not None and self._wanted(
            TriggerMoment(t=t, x=x, y=y, speed=speed, target=target, soon=soon, since_asked_s=since_s)
        )
        cause: Cause | None = None
        if target is None:
            cause = "first"
        elif stuck:
            cause = "stuck"
        elif self._failures >= cfg.max_failures:
            cause = "failure"
        elif self._deviated:
            cause = "deviation"
        elif self._wanted is not None:
            cause = "own" if wished else None
        elif cfg.always or (soon if soon is not None else math.hypot(target[0] - x, target[1] - y) < cfg.distance_m):
            cause = "distance"
        if cause is None:
            return None
        if pending:
            return Firing(cause=cause, held_by="pending")
        if cause != "stuck" and since_s < cfg.cooldown_s:
            return Firing(cause=cause, held_by="cooldown")
        return Firing(cause=cause, held_by="")

    def _stuck(self, t: float, x: float, y: float, speed: float) -> bool:
        cfg = self.cfg
        self._history.append((t, x, y))
        while self._history[0][0] < t - cfg.stuck_time_s:
            self._history.popleft()
        if speed >= cfg.stuck_speed_m_s:
            self._slow_since = None
            return False
        if self._slow_since is None:
            self._slow_since = t
        if t - self._slow_since < cfg.stuck_time_s:
            return False
        return max(math.hypot(x - px, y - py) for _, px, py in self._history) < cfg.stuck_move_m


def separated(new: tuple[float, float], previous: tuple[float, float] | None, separation_m: float) -> bool:
    """Check whether a new waypoint lies at least `separation_m` from the previous one (Delta d_min)."""
    return previous is None or math.hypot(new[0] - previous[0], new[1] - previous[1]) >= separation_m - 1e-6
