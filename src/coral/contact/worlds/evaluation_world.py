"""What an episode needs of the world that it takes place in, whatever simulates or is it."""

from __future__ import annotations

from typing import Protocol

from coral.contact.scene.observation import HandTarget, Observation, Truth


class WorldError(RuntimeError):
    """The world can no longer be stepped.

    Args:
        code: Why: "diverged", "tunnelling", "unreachable", "camera-off", "not-found", "tracker-failed".
        text: For people.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


class EvaluationWorld(Protocol):
    """Where an episode takes place: a simulated Panda, a free-flying hand, or a robot."""

    name: str
    control_period_s: float

    def reset(self) -> Observation:
        """Everything back to the beginning of the episode."""
        ...

    def step(self, target: HandTarget) -> Observation:
        """One control period.

        Raises:
            WorldError: The simulation diverged, or the robot cannot go on.
        """
        ...

    def truth(self) -> Truth:
        """The state that success is judged by."""
        ...

    def close(self) -> None:
        """Free what the world holds."""
        ...
