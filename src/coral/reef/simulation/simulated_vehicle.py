"""The simulated vehicle as the mission loop sees it."""

from __future__ import annotations

from collections.abc import Callable

from coral.reef.simulation.simulator import ReefSimulator
from coral.reef.vehicle.sensing import VehicleObservation


class SimulatedVehicle:
    """Observes and moves in simulated time: a command moves it to the next tick."""

    def __init__(self, simulator: ReefSimulator, period_s: float, tell: Callable[..., None]) -> None:
        """Set up with `period_s` between two ticks; tell(event, **fields) is told of contacts."""
        self.simulator, self._period_s, self._tell = simulator, period_s, tell
        self._begun = False

    def observe(self, t: float) -> VehicleObservation:
        """Measure everything at time `t` (s), one period after the last time."""
        sensed = self.simulator.sense(self._period_s if self._begun else 0.0)
        self._begun = True
        return VehicleObservation.at(t, sensed.pose, sensed.velocity, sensed.frame, sensed.attitude, sensed.sonar)

    def command(self, command: tuple[float, float]) -> None:
        """Drive at (m/s, rad/s) for one period."""
        for x, y, obstacle in self.simulator.act(command, self._period_s):
            self._tell("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)
