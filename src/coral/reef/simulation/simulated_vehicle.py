"""The simulated vehicle as the mission loop sees it, alone or among others in one reef."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from coral.reef.simulation.encounter import Encounters
from coral.reef.simulation.simulator import ReefSimulator
from coral.reef.vehicle.sensing import Stamped, VehicleObservation


class SimulatedVehicle:
    """Observes and moves in simulated time: a command moves it to the next tick, past the others of its fleet."""

    def __init__(
        self,
        simulator: ReefSimulator,
        period_s: float,
        tell: Callable[..., None],
        encounters: Encounters | None = None,
    ) -> None:
        """Set up.

        Args:
            simulator: The reef around it.
            period_s: Time between two ticks.
            tell: tell(event, **fields) is told of contacts.
            encounters: Counts contacts with the others; None if it is alone.
        """
        self.simulator, self._period_s, self._tell, self._encounters = simulator, period_s, tell, encounters
        self.fleet: list[SimulatedVehicle] = [self]
        """All vehicles in the reef, with this one."""
        self._begun = False

    @property
    def position(self) -> tuple[float, float]:
        """True position (m)."""
        x, y, _ = self.simulator.pose
        return x, y

    def observe(self, t: float) -> VehicleObservation:
        """Measure everything at time `t` (s), one period after the last time."""
        sensed = self.simulator.sense(self._period_s if self._begun else 0.0)
        self._begun = True
        seen = VehicleObservation.at(t, sensed.pose, sensed.velocity, sensed.frame, sensed.attitude, sensed.sonar)
        if sensed.covariance is None:
            return seen
        measured = Stamped(t - sensed.velocity_age_s, sensed.velocity)
        return replace(seen, covariance=sensed.covariance, velocity=measured)

    def command(self, command: tuple[float, float]) -> None:
        """Drive at (m/s, rad/s) for one period."""
        others = [other.position for other in self.fleet if other is not self]
        for x, y, obstacle in self.simulator.act(command, self._period_s, others):
            self._tell("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)
        if self._encounters is not None:
            number, positions = self.fleet.index(self), [each.position for each in self.fleet]
            for x, y, met in self._encounters.follow(number, self.simulator.track, positions):
                self._tell("robot_collision", x=round(x, 3), y=round(y, 3), other=met)
