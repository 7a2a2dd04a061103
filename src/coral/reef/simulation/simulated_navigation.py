"""The simulated navigation of a vehicle: truth in; pose, velocity and attitude as its sensors let it know them out."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from coral.reef.simulation.depth_sensor import DepthSensorCfg, SimulatedDepthSensor
from coral.reef.simulation.doppler_log import DvlCfg, SimulatedDvl
from coral.reef.simulation.inertial_filter import GYRO, InertialFilter
from coral.reef.simulation.inertial_unit import ImuCfg, SimulatedImu
from coral.reef.simulation.noise import PoseDrift, SensorNoiseCfg
from coral.reef.vehicle.sensing import Attitude, Velocity
from coral.reef.world.geometry import Pose, wrap


@dataclass(frozen=True, kw_only=True)
class NavigationCfg:
    """Where pose, velocity and attitude come from."""

    source: Literal["drift", "dvl-imu"] = "drift"
    """drift: the truth, with the random walk of `simulator.noise.drift_xy` and `drift_theta` if they are not 0; exact
    velocity and attitude. dvl-imu: dead reckoning by Doppler log, IMU and depth sensor, with their errors."""
    dvl: DvlCfg = field(default_factory=DvlCfg)
    imu: ImuCfg = field(default_factory=ImuCfg)
    depth: DepthSensorCfg = field(default_factory=DepthSensorCfg)


@dataclass(frozen=True, kw_only=True)
class NavigationFix:
    """What navigation knows at one moment."""

    pose: Pose
    """Dead reckoned, in the frame where the start was known."""
    covariance: NDArray[np.float64] | None
    """Of the pose: x, y (m), theta (rad); None: unknown. Shape=(3, 3)."""
    velocity: Velocity
    """Over ground, as estimated."""
    velocity_age_s: float
    """Time since the last ping with bottom lock (s): what the velocity is worth."""
    attitude: Attitude


class Navigation(Protocol):
    """What tells a vehicle where it is."""

    def step(self, pose: Pose, velocity: Velocity, attitude: Attitude, dt: float) -> NavigationFix:
        """Measure and estimate, `dt` seconds after the last call.

        Args:
            pose: True pose.
            velocity: True velocity over ground in the body frame.
            attitude: True roll, pitch, depth and altitude.
            dt: Time since the last call (s); 0 in the first.
        """
        ...


class DriftingNavigation:
    """Tells the truth, but for a random walk of the pose."""

    def __init__(self, noise: SensorNoiseCfg, rng: np.random.Generator) -> None:
        self._drift = PoseDrift(noise, rng)

    def step(self, pose: Pose, velocity: Velocity, attitude: Attitude, dt: float) -> NavigationFix:
        """Let the pose drift for `dt` seconds."""
        drifted = self._drift.step(pose, dt)
        return NavigationFix(pose=drifted, covariance=None, velocity=velocity, velocity_age_s=0.0, attitude=attitude)


def make_navigation(cfg: NavigationCfg, noise: SensorNoiseCfg, start: Pose, rng: np.random.Generator) -> Navigation:
    """Make the navigation of a vehicle that begins at a known pose."""
    return (
        SimulatedNavigation(cfg, start, rng.spawn(1)[0]) if cfg.source == "dvl-imu" else DriftingNavigation(noise, rng)
    )


class SimulatedNavigation:
    """Runs the sensors and the filter along the true motion of a vehicle."""

    def __init__(self, cfg: NavigationCfg, start: Pose, rng: np.random.Generator) -> None:
        """Begin at rest at a known pose. Each sensor has a stream of its own."""
        log, unit, depth = rng.spawn(3)
        self.dvl, self.imu = SimulatedDvl(cfg.dvl, log), SimulatedImu(cfg.imu, unit)
        self.depth = SimulatedDepthSensor(cfg.depth, depth)
        self.filter = InertialFilter(start, cfg.imu, cfg.dvl)
        self._depth_std_m = math.hypot(cfg.depth.offset_m, cfg.depth.noise_m)
        self._before = (start.theta, 0.0, 0.0)
        self._since_ping_s = 0.0
        self._turn = 0.0
        self._altitude_m: float | None = None

    def step(self, pose: Pose, velocity: Velocity, attitude: Attitude, dt: float) -> NavigationFix:
        """Measure and estimate, `dt` seconds after the last call.

        Args:
            pose: True pose.
            velocity: True velocity over ground in the body frame.
            attitude: True roll, pitch, depth and altitude.
            dt: Time since the last call (s); 0 in the first.
        """
        assert attitude.altitude_m is not None
        u, v = velocity[:2]
        theta, last_u, last_v = self._before
        self._before = pose.theta, u, v
        self._since_ping_s += dt
        roll, pitch = attitude.roll, attitude.pitch
        if dt > 0.0:
            turn = wrap(pose.theta - theta) / dt
            force = (u - last_u) / dt - turn * 0.5 * (v + last_v), (v - last_v) / dt + turn * 0.5 * (u + last_u)
            felt = self.imu.measure(turn, force, (roll, pitch), dt)
            self._turn, roll, pitch = felt.turn_rad_s - float(self.filter.state[GYRO]), felt.roll_rad, felt.pitch_rad
            self.filter.predict(felt, dt)
        ping = self.dvl.measure((u, v), attitude.altitude_m, dt)
        if ping is not None:
            self._since_ping_s, self._altitude_m = 0.0, ping.altitude_m
            self.filter.correct(ping)
        return NavigationFix(
            pose=self.filter.pose,
            covariance=self.filter.covariance,
            velocity=(*self.filter.velocity, self._turn),
            velocity_age_s=self._since_ping_s,
            attitude=Attitude(
                roll=roll,
                pitch=pitch,
                depth_m=self.depth.measure(attitude.depth_m),
                altitude_m=self._altitude_m,
                tilt_std_rad=self.imu.tilt_std_rad,
                depth_std_m=self._depth_std_m,
            ),
        )
