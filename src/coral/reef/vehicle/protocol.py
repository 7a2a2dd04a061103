"""What the mission loop needs of a vehicle, simulated or real: one observation and one command a tick."""

from __future__ import annotations

from typing import Protocol

from coral.reef.vehicle.sensing import VehicleObservation


class Vehicle(Protocol):
    """A vehicle that surveys. Neither method waits."""

    def observe(self, t: float) -> VehicleObservation:
        """Return the newest measurements at time `t` of the mission (s), in the survey's frame."""
        ...

    def command(self, command: tuple[float, float]) -> None:
        """Follow a forward speed (m/s) and a yaw rate (rad/s, positive to the left) until the next command."""
        ...
