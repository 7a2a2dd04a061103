"""The interface between an episode and a simulated world: a robot's world, and the truth by which success is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import mujoco
import numpy as np

from coral.contact.scene.observation import BodyState, Truth
from coral.contact.worlds.robot_world import RobotWorld


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


@runtime_checkable
class EvaluationWorld(TruthfulWorld, Protocol):
    """A world that also knows the truth: a simulated Panda or a free-flying hand."""

    @property
    def simulation(self) -> Simulation | None:
        """Return the simulation, for simulated cameras and recordings of joint positions; None without MuJoCo.

        It is for sensors and records only: a decision must not read it.
        """


class WrappedWorld:
    """A world around another one, of which it changes what is observed; all else is the other one's."""

    def __init__(self, world: EvaluationWorld) -> None:
        self._world = world
        self.name, self.control_period_s, self.simulation = world.name, world.control_period_s, world.simulation

    def truth(self) -> Truth:
        """See `EvaluationWorld.truth`."""
        return self._world.truth()

    def stop(self) -> None:
        """See `RobotWorld.stop`."""
        self._world.stop()

    def close(self) -> None:
        """See `RobotWorld.close`."""
        self._world.close()


def body_state(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> BodyState:
    """Return the pose and velocity of a body, world frame."""
    body, motion = model.body(name).id, np.zeros(6)
    mujoco.mj_objectVelocity(model, data, int(mujoco.mjtObj.mjOBJ_XBODY), body, motion, 0)
    return BodyState(data.xpos[body].copy(), data.xquat[body].copy(), motion[3:].copy(), motion[:3].copy())


def simulation_of(world: RobotWorld) -> Simulation | None:
    """Return the simulation behind a world; None behind a robot."""
    return world.simulation if isinstance(world, EvaluationWorld) else None
