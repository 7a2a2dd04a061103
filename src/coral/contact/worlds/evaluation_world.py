"""The interface between an episode and a simulated world: a robot's world, and the truth by which success is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import mujoco

from coral.contact.scene.observation import Truth
from coral.contact.worlds.robot_world import RobotWorld, WorldError

__all__ = ["EvaluationWorld", "Simulation", "TruthfulWorld", "WorldError", "simulation_of"]


@dataclass(frozen=True)
class Simulation:
    """The MuJoCo simulation behind a world."""

    model: mujoco.MjModel
    """The model: bodies, joints and shapes; constant."""
    data: mujoco.MjData
    """The present state; the world changes it in place."""


@runtime_checkable
class TruthfulWorld(RobotWorld, Protocol):
    """A world whose true state the judge may ask for."""

    def truth(self) -> Truth:
        """Return the true state, by which success is judged."""
        ...


@runtime_checkable
class EvaluationWorld(TruthfulWorld, Protocol):
    """A world that also knows the truth: a simulated Panda or a free-flying hand."""

    @property
    def simulation(self) -> Simulation | None:
        """Return the simulation, for simulated cameras and recordings of joint positions; None without MuJoCo.

        It is for sensors and records only: a decision must not read it.
        """
        ...


def simulation_of(world: RobotWorld) -> Simulation | None:
    """Return the simulation behind a world; None behind a robot."""
    return world.simulation if isinstance(world, EvaluationWorld) else None
