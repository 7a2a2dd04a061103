"""The mission loop: tick by tick the robot observes, decides and is commanded (paper Alg. 1)."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from coral.reef.mission.robot import Robot


class Ticks(Protocol):
    """When the ticks of a mission are: in simulated or in real time."""

    def begin(self, step: int) -> tuple[float, float]:
        """Wait until tick number `step` is due. Return its time, and that since the last one (s)."""

    def end(self, step: int) -> float:
        """Return the time (s) after the command of a tick; `step` ticks are done."""


class SimulatedTicks:
    """Ticks in simulated time, which never waits: a command moves the world by one period."""

    def __init__(self, period_s: float) -> None:
        self.period_s = period_s

    def begin(self, step: int) -> tuple[float, float]:
        """Return the time of a tick and the period (s)."""
        return self.end(step), self.period_s if step else 0.0

    def end(self, step: int) -> float:
        """Return the time after `step` periods (s)."""
        return round(step * self.period_s, 9)


class MissionLoop(ABC):
    """Drives a robot, whatever vehicle and whatever time it has.

    What stands round the loop is added by a mission of its kind: record and judge; at sea also the operator, the limits
    and the way home.
    """

    def __init__(self, robot: Robot, ticks: Ticks) -> None:
        self.robot, self._ticks = robot, ticks
        self.belief, self.pilot = robot.belief, robot.pilot
        self.step, self.t = 0, 0.0
        """Ticks that are done, and the time of the mission (s)."""
        self.end_reason = ""
        """Why the mission is over, or ""."""
        self.calls = self.collisions = 0
        """Questions that were asked, and contacts that the truth knows of."""
        self.answer: str | None = None
        """What the advisor answered when it said that a mission in words was done."""
        self.control_ms: list[float] = []
        """Wall time of the robot's computation at each tick (ms)."""
        self.tick_ms: list[float] = []
        """Wall time of each tick (ms), without waiting."""

    @property
    def instruction(self) -> str:
        """The instruction of a mission in words, as it is now; "" without one."""
        return self.pilot.planner.cfg.instruction.text

    @property
    def instructing(self) -> Callable[[str, str], bool] | None:
        """How the instruction is changed, from any thread; None where there is none to change."""
        return self.pilot.instruct if self.instruction else None

    def count(self, event: str, fields: Mapping[str, Any]) -> None:
        """Take note of an event."""
        self.calls += event == "question"
        self.collisions += event == "collision"
        if event == "held" and "answer" in fields:
            self.answer = str(fields["answer"])

    @abstractmethod
    def located(self) -> None:
        """The robot has observed, and knows where it is."""

    def decided(self) -> None:
        """The robot has decided; its command may still be changed."""
        return

    @abstractmethod
    def commanded(self) -> str:
        """The command is out and the step is counted. Return why the mission is over, or ""."""

    def advance(self) -> None:
        """Run one control tick."""
        robot = self.robot
        self.t, dt = self._ticks.begin(self.step)
        begun = time.perf_counter()
        robot.sense(self.t)
        thinking = time.perf_counter()
        robot.localize(dt)
        located_s = time.perf_counter() - thinking
        self.located()
        thinking = time.perf_counter()
        # The wait for a due reply, while simulated time stands still, is no part of the control period.
        waited = robot.think()
        self.control_ms.append(1e3 * (located_s + time.perf_counter() - thinking - waited))
        self.decided()
        self.step += 1
        self.t = self._ticks.end(self.step)
        robot.act()
        self.end_reason = self.commanded()
        self.tick_ms.append(1e3 * (time.perf_counter() - begun - waited))
