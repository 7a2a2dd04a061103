"""The interface between an episode and its world: a simulation or a real robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import mujoco

from coral.contact.scene.observation import HandTarget, Observation, Truth


class WorldError(RuntimeError):
    """The world cannot be stepped any further.

    Args:
        code: Reason: "diverged", "tunnelling", "unreachable", "camera-off", "not-found", "tracker-failed".
        text: Message for people.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


@dataclass(frozen=True)
class Simulation:
    """The MuJoCo simulation behind a world."""

    model: mujoco.MjModel
    """The model: bodies, joints and shapes; constant."""
    data: mujoco.MjData
    """The present state; the world changes it in place."""


class EvaluationWorld(Protocol):
    """World of an episode: a simulated Panda, a free-flying hand, or a robot.

    Attributes:
        name: Name for records.
        control_period_s: Duration of one `step`.
    """

    name: str
    control_period_s: float

    @property
    def simulation(self) -> Simulation | None:
        """Return the simulation, for simulated cameras and recordings of joint positions; None without MuJoCo.

        It is for sensors and records only: a decision must not read it.
        """
        ...

    def reset(self) -> Observation:
        """Return to the start of the episode."""
        ...

    def step(self, target: HandTarget) -> Observation:
        """Advance by one control period with the hand pulled towards `target`.

        Raises:
            WorldError: The simulation diverged, or the robot cannot continue.
        """
        ...

    def truth(self) -> Truth:
        """Return the true state, by which success is judged."""
        ...

    def close(self) -> None:
        """Release the world's resources."""
        ...
