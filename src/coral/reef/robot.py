"""One robot of a mission: a vehicle with its sensors in the simulated reef, and the pilot that drives it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.reef.belief import Belief
from coral.reef.fleet import Neighbour
from coral.reef.pilot import Command, LocalPlanner, Pilot
from coral.reef.simulator import ReefSimulator, Sensed

Build = Callable[["Robot"], Pilot]
"""Makes the pilot of a robot."""


class Robot:
    """Couples one vehicle with its pilot; its events go to `emit`."""

    def __init__(
        self,
        number: int,
        simulator: ReefSimulator,
        belief: Belief,
        driver: LocalPlanner,
        clock: SimulatedClock,
        emit: Callable[..., None],
        build: Build,
        alone: bool,
    ) -> None:
        self.number, self.simulator, self.belief, self.driver, self.clock = number, simulator, belief, driver, clock
        self._emit, self._alone = emit, alone
        self.sensed: Sensed | None = None
        self.command: Command = (0.0, 0.0)
        self.pilot = build(self)

    def emit(self, event: str, **fields: Any) -> None:
        """Emit an event, with the number of the robot if there are several."""
        self._emit(event, **(fields if self._alone else {"robot": self.number, **fields}))

    def sense(self, dt: float) -> Sensed:
        """Take a picture, `dt` seconds after the last one."""
        self.sensed = self.simulator.sense(dt)
        return self.sensed

    def think(self, t: float, others: Iterable[Neighbour]) -> float:
        """Choose the next command at time `t` (s); return the wall time spent waiting for a reply (s)."""
        assert self.sensed is not None
        waited, self.belief.others = self.clock.waited_s, tuple(others)
        self.command = self.pilot.tick(t, self.sensed.frame, self.sensed.pose, self.sensed.velocity)
        return self.clock.waited_s - waited

    def act(self, dt: float, others: Iterable[tuple[float, float]]) -> None:
        """Drive for `dt` seconds among robots at the positions `others` (m)."""
        for x, y, obstacle in self.simulator.act(self.command, dt, tuple(others)):
            self.emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)

    def says(self) -> Neighbour:
        """Return what it tells the other robots."""
        assert self.sensed is not None
        about, plan, belief = self.pilot, self.pilot.plan, self.belief
        busy = not about.end_reason
        path, times = (np.empty((0, 2)), np.empty(0)) if plan is None else (plan.path[:, :2], plan.times)
        return Neighbour(
            pose=self.sensed.pose,
            radius_m=self.simulator.cfg.vehicle.hull_radius_m,
            goal=belief.goal if busy else None,
            index=belief.goal_index if busy else None,
            later=frozenset(g.index for g in about.route.goals[1:] if g.index is not None) if busy else frozenset(),
            path=path,
            times=times,
        )

    @property
    def position(self) -> tuple[float, float]:
        """True position (m)."""
        x, y, _ = self.simulator.pose
        return x, y
