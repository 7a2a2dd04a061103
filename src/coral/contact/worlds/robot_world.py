"""The interface between an episode and a robot: measure, act, stop. It knows nothing that the robot does not."""

from __future__ import annotations

from typing import Protocol

from coral.contact.scene.observation import HandTarget, Observation


class WorldError(RuntimeError):
    """The world cannot be stepped any further; the text is for people.

    The code is "diverged", "unreachable", "camera-off", "not-found", "tracker-failed"; of an arm "limit", "poses-lost",
    "link-lost", "watchdog", "arm-fault", "stopped by the operator".
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


class RobotWorld(Protocol):
    """A robot and its surroundings, real or simulated, as far as sensors tell.

    Observations carry the time of their measurement and are as noisy as the sensors. There is no true state:
    `EvaluationWorld` adds it for simulations. One `step` lasts `control_period_s`.
    """

    name: str
    control_period_s: float

    def reset(self) -> Observation:
        """Bring the robot to the start of the episode, and measure."""

    def step(self, target: HandTarget) -> Observation:
        """Pull the hand towards `target` for one control period, and measure at its end.

        Raises:
            WorldError: The robot cannot continue.
        """

    def stop(self) -> None:
        """Stop all motion. An episode calls it once, as soon as it ends for whatever reason; never raises."""

    def close(self) -> None:
        """Release the world's resources."""


def in_real_time(world: RobotWorld) -> bool:
    """Return whether a world's time passes between steps, as a robot's does; it then has `in_real_time`."""
    return bool(getattr(world, "in_real_time", False))
