"""The interface between an episode and the world it runs in: a simulation, or a real robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import mujoco

from coral.contact.scene.observation import HandTarget, Observation, Truth


class WorldError(RuntimeError):
    """The world can no longer be stepped.

    Args:
        code: Why: "diverged", "tunnelling", "unreachable", "camera-off", "not-found", "tracker-failed".
        text: The message shown to people.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


@dataclass(frozen=True)
class Simulation:
    """The MuJoCo simulation behind a world."""

    model: mujoco.MjModel
    """Bodies, joints and shapes; fixed."""
    data: mujoco.MjData
    """The present state; the world changes it in place as it steps."""


class EvaluationWorld(Protocol):
    """Where an episode runs: a simulated Panda, a free-flying hand, or a robot.

    Attributes:
        name: For records.
        control_period_s: How long one `step` lasts.
    """

    name: str
    control_period_s: float

    @property
    def simulation(self) -> Simulation | None:
        """What simulated cameras draw and recordings of joint positions read; None for a world without MuJoCo.

        It is for sensors and records only: a decision must not read it.
        """
        ...

    def reset(self) -> Observation:
        """Return to the start of the episode."""
        ...

    def step(self, target: HandTarget) -> Observation:
        """Advance by one control period with the hand pulled towards `target`.

        Raises:
            WorldError: The simulation diverged, or the robot cannot go on.
        """
        ...

    def truth(self) -> Truth:
        """The true state, by which success is judged."""
        ...

    def close(self) -> None:
        """Release the world's resources."""
        ...
