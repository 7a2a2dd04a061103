"""Plans that come late: how late they are, what the hand follows until then, and a robot that moves meanwhile."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from statistics import median
from types import TracebackType

from coral.advisor.latency import parse_latency
from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.reactive import Reactive
from coral.contact.cost.context import Array
from coral.contact.scene.observation import HandTarget, Observation
from coral.errors import InputError

FORMS = "0, SECONDS, fixed:SECONDS or measured"
REMEMBERED = 25
"""Number of plans whose durations predict the next one's."""


class PlanLatency:
    """Counts a plan's duration in control steps of `step_s` (s), before it is computed and after.

    `0`: the world stands still while a plan is computed. `SECONDS` or `fixed:SECONDS`: every plan takes so
    long, whatever the machine. `measured`: as long as it takes here. A plan has `most` control steps, and `least` lie
    between two.

    Raises:
        InputError: The text is none of these, or no part of a plan would be left when it is ready.
    """

    def __init__(self, spec: str, step_s: float, least: int, most: int) -> None:
        self._step_s, self._least, self._most = step_s, least, most
        self._durations: deque[float] = deque(maxlen=REMEMBERED)
        self.fixed_s = _fixed(spec)
        if self.fixed_s is not None and self.fixed_s >= most * step_s:
            raise InputError("--cfg", "planning.latency", repr(spec), f"less than a plan's {most * step_s:g} s")

    @property
    def charged(self) -> bool:
        """Whether the world moves while a plan is computed."""
        return self.fixed_s != 0.0

    @property
    def plan_s(self) -> float:
        """Return how long a plan takes (s): as fixed, or the median so far; 0 if the world stands still."""
        if self.fixed_s is not None:
            return self.fixed_s
        return median(self._durations) if self._durations else 0.0

    def expected_steps(self) -> int:
        """Return the control steps until a plan that is begun now will be ready."""
        spare = 1.0 if self.fixed_s is not None else 1.1
        return max(self._least, self._steps(spare * self.plan_s))

    def taken_steps(self, seconds: float) -> int:
        """Return the control steps that pass until a plan that took `seconds` on this machine is ready."""
        if self.fixed_s is not None:
            return self.expected_steps()
        self._durations.append(seconds)
        return max(self._least, self._steps(seconds))

    def _steps(self, seconds: float) -> int:
        return min(math.ceil(seconds / self._step_s - 1e-9), self._most - 1)


def _fixed(spec: str) -> float | None:
    """Return the fixed latency (s); None if it is measured."""
    with suppress(InputError):
        latency = parse_latency(spec)
        if latency.kind in ("fixed", "measured"):
            return latency.median_s if latency.kind == "fixed" else None
    raise InputError("--cfg", "planning.latency", repr(spec), FORMS)


@dataclass
class PlanUnderWay:
    """A plan, from the step with which its execution begins."""

    plan: HandPlan
    first: int = 0
    """Index of that step. A plan that came late is used from where it still holds."""
    moved: Array | None = None
    """Where the tool was at the beginning, relative to where it had been predicted, Shape=(3,) m: errors of the plan
    count from there, since earlier ones have been counted in the plan before. None: as predicted."""

    def __post_init__(self) -> None:
        self.next = self.first

    @classmethod
    def beginning(cls, plan: HandPlan, first: int, predicted: Observation, now: Observation) -> PlanUnderWay:
        """Begin a plan at step `first`, that was made from the state `predicted`."""
        position = predicted.tool.position
        if first and plan.expected_position is not None:
            # On a busy machine the robot outruns a plan.
            position = plan.expected_position[min(first, len(plan.expected_position)) - 1]
        return cls(plan, first, now.tool.position - position)

    def coming(self, steps: int) -> tuple[HandTarget, ...]:
        """Return the targets of the next steps; the last one stays when the plan is at its end."""
        targets = self.plan.targets
        return tuple(targets[min(self.next + k, len(targets) - 1)] for k in range(steps))

    def compare(self, k: int, now: Observation, reactive: Reactive) -> None:
        """Tell the feedback what step k was predicted to lead to, if it was predicted, and what it led to."""
        positions, forces = self.plan.expected_position, self.plan.expected_force
        if positions is not None and forces is not None:
            moved = 0.0 if self.moved is None else self.moved
            reactive.observe(positions[k] + moved, forces[k], now, k - self.first)


class Meanwhile:
    """Takes steps in a thread for as long as a `with` block lasts, or until a step returns False.

    A block of planning spends its time in MuJoCo, which lets other threads run; a step spends it waiting for the robot.
    `steps` counts those taken in the last block.
    """

    def __init__(self, step: Callable[[], bool]) -> None:
        self._step = step
        self.steps = 0
        self._error: BaseException | None = None
        self._done = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> Meanwhile:
        """Begin."""
        self.steps, self._error = 0, None
        self._done.clear()
        self._thread = threading.Thread(target=self._run, name="meanwhile", daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait for the end of the present step; raise what a step raised, unless the block failed itself."""
        self._done.set()
        if self._thread is not None:
            self._thread.join()
        if self._error is not None and error is None:
            raise self._error

    def _run(self) -> None:
        try:
            while not self._done.is_set():
                if not self._step():
                    return
                self.steps += 1
        except BaseException as error:
            self._error = error
