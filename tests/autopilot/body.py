"""The body that the simulated autopilot moves: the reef's planar vehicle, and a depth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from coral.reef.simulation.simulator import ReefSimulator, SimulatorCfg
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Pose

HEAVE_S = 0.5
"""Time constant of the vertical speed: ArduSub in the loop reaches a climb rate within a second."""
RISE_M_S = 0.1
"""Upward speed without thrust: positive buoyancy, as the simulated vehicle of ArduSub rises."""


class PlanarMover(Protocol):
    """What moves in the plane; `ReefSimulator` is one, with obstacles, contacts and coverage."""

    @property
    def vehicle(self) -> VehicleDynamics:
        """The vehicle that moves."""
        ...

    def act(self, command: tuple[float, float], dt: float) -> Sequence[Any]:
        """Drive at (m/s forward, rad/s left) for `dt` seconds."""
        ...


class OpenWater:
    """A vehicle in water without obstacles."""

    def __init__(self, cfg: VehicleCfg | None = None, start: Pose | None = None) -> None:
        self.vehicle = VehicleDynamics(cfg, start or Pose(0.0, 0.0, 0.0))

    def act(self, command: tuple[float, float], dt: float) -> Sequence[Any]:
        """Drive for `dt` seconds."""
        self.vehicle.step(command, dt)
        return ()


class ReefWaters:
    """A reef by name or file, or open water for "": moves a vehicle and counts what it touches."""

    def __init__(self, world: str, cfg: SimulatorCfg | None = None) -> None:
        """Put a vehicle at the start of a reef.

        Raises:
            InputError: There is no such world.
        """
        self.mover: PlanarMover = OpenWater()
        if world:
            self.mover = ReefSimulator(find_world(world), cfg or SimulatorCfg(), np.random.default_rng(0))
        self.collisions = 0
        self.distance_m = 0.0

    @property
    def vehicle(self) -> VehicleDynamics:
        """The vehicle that swims."""
        return self.mover.vehicle

    def act(self, command: tuple[float, float], dt: float) -> Sequence[Any]:
        """Drive for `dt` seconds. Return new contacts with obstacles."""
        x, y = self.vehicle.state[:2]
        contacts = self.mover.act(command, dt)
        self.collisions += len(contacts)
        self.distance_m += math.dist((x, y), self.vehicle.state[:2])
        return contacts


class Body:
    """The true state of a vehicle, and what thrust does to it.

    Simplifications: sway is held at zero. A vehicle without thrust coasts and rises, but no current carries it.
    """

    def __init__(self, mover: PlanarMover, depth_m: float = 0.0) -> None:
        self.mover = mover
        self.depth_m = depth_m
        self.down_m_s = 0.0
        self._coast = (0.0, 0.0)

    @property
    def pose(self) -> Pose:
        """True pose (world ENU)."""
        return Pose(*self.mover.vehicle.state[:3])

    @property
    def velocity(self) -> tuple[float, float, float]:
        """True velocity over ground, body FLU."""
        u, v, r = self.mover.vehicle.state[3:6]
        return u, v, r

    def swim(self, forward_m_s: float, yaw_rate_rad_s: float, down_m_s: float, dt: float) -> None:
        """Follow a velocity for `dt` seconds."""
        self.mover.act((forward_m_s, yaw_rate_rad_s), dt)
        self._coast = (self.velocity[0], self.velocity[2])
        self._heave(down_m_s, dt)

    def push(self, surge: float, yaw_rate_rad_s: float, down_m_s: float, dt: float) -> None:
        """Thrust forward with a share of all thrust (-1 to 1), at a yaw rate, for `dt` seconds.

        The speed follows from the vehicle's mass and drag (`dynamics.planar`).
        """
        model = self.mover.vehicle.model
        u = self._coast[0]
        force = surge * model.force_arm * model.thrust_max - model.du * u - model.duu * u * abs(u)
        limit = self.mover.vehicle.cfg.max_speed_m_s
        u = min(max(u + force / model.m11 * dt, -limit), limit)
        self.mover.act((u, yaw_rate_rad_s), dt)
        self._coast = (u, yaw_rate_rad_s)
        self._heave(down_m_s, dt)

    def coast(self, dt: float) -> None:
        """Move without thrust for `dt` seconds."""
        self.push(0.0, self._coast[1] * math.exp(-dt / HEAVE_S), -RISE_M_S, dt)

    def _heave(self, down_m_s: float, dt: float) -> None:
        share = -math.expm1(-dt / HEAVE_S)
        self.down_m_s += share * (down_m_s - self.down_m_s)
        self.depth_m += self.down_m_s * dt
        if self.depth_m <= 0.0:
            self.depth_m, self.down_m_s = 0.0, max(self.down_m_s, 0.0)
