"""One robot of a mission: a vehicle with its sensors in the simulated reef, and the pilot that drives it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.reef.belief import Belief
from coral.reef.fleet import Neighbour
from coral.reef.geometry import Pose
from coral.reef.localization import Localizer
from coral.reef.pilot import Command, LocalPlanner, Pilot
from coral.reef.simulator import ReefSimulator, Sensed

Build = Callable[["Robot"], Pilot]
"""Builds the pilot of a robot."""


class Robot:
    """Couples a simulated vehicle with its pilot."""

    def __init__(
        self,
        number: int,
        simulator: ReefSimulator,
        belief: Belief,
        localizer: Localizer,
        driver: LocalPlanner,
        clock: SimulatedClock,
        emit: Callable[..., None],
        build: Build,
        alone: bool,
    ) -> None:
        self.number, self.simulator, self.belief, self.driver, self.clock = number, simulator, belief, driver, clock
        self.localizer, self.pose = localizer, simulator.pose
        """Where the robot believes it is: the odometry, corrected. It knows its start."""
        self._emit, self._alone = emit, alone
        self.sensed: Sensed | None = None
        self.command: Command = (0.0, 0.0)
        self.pilot = build(self)

    def emit(self, event: str, **fields: Any) -> None:
        """Emit an event, with the number of the robot if it is not alone."""
        self._emit(event, **(fields if self._alone else {"robot": self.number, **fields}))

    def sense(self, dt: float) -> Sensed:
        """Take a picture `dt` seconds after the last one."""
        self.sensed = self.simulator.sense(dt)
        return self.sensed

    def localize(self, dt: float) -> Pose:
        """Correct the odometry of the last picture, `dt` seconds after the one before."""
        assert self.sensed is not None
        self.pose = self.localizer.update(self.sensed.frame, self.sensed.pose, dt)
        return self.pose

    def think(self, t: float, others: Iterable[Neighbour]) -> float:
        """Choose the next command at time `t` (s). Return the wall time spent waiting for a reply (s)."""
        assert self.sensed is not None
        waited, self.belief.others = self.clock.waited_s, tuple(others)
        self.command = self.pilot.tick(t, self.sensed.frame, self.pose, self.sensed.velocity)
        return self.clock.waited_s - waited

    def act(self, dt: float, others: Iterable[tuple[float, float]]) -> None:
        """Drive for `dt` seconds among robots at the positions `others` (m)."""
        for x, y, obstacle in self.simulator.act(self.command, dt, tuple(others)):
            self.emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)

    def says(self) -> Neighbour:
        """Return what it tells the other robots."""
        about, plan, belief = self.pilot, self.pilot.plan, self.belief
        busy = not about.end_reason
        path, times = (np.empty((0, 2)), np.empty(0)) if plan is None else (plan.path[:, :2], plan.times)
        return Neighbour(
            pose=self.pose,
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
