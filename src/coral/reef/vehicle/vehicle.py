"""The simulated BlueROV2: a velocity loop over its thrusters, commanded by forward speed and yaw rate."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive, TimeStep
from coral.errors import InputError
from coral.reef.vehicle.dynamics import THRUST_MAX_N, Thrusters, planar
from coral.reef.vehicle.dynamics_kernels import planar_drive
from coral.reef.vehicle.tour_kernels import advance
from coral.reef.world.geometry import Pose

Clearance = Callable[[float, float], float]


class VehicleState(NamedTuple):
    """Pose in the world (m, m, rad) and ground-relative velocity in the body frame (m/s, m/s, rad/s)."""

    x: float
    y: float
    theta: float
    u: float = 0.0
    v: float = 0.0
    r: float = 0.0


@dataclass(frozen=True, kw_only=True)
class VehicleCfg:
    """BlueROV2 Heavy and its velocity loop. The limits lie inside the thrusters' envelope."""

    model: Literal["planar", "kinematic"] = "planar"
    """kinematic: the vehicle moves exactly as commanded, without inertia, drag or current; for bounds, not missions."""
    thrusters: Thrusters = field(default_factory=Thrusters)
    thrust_max_n: Positive = THRUST_MAX_N
    max_speed_m_s: Positive = 0.6
    max_yaw_rate_rad_s: Positive = 0.6
    hull_radius_m: Positive = 0.3
    """Paper Sec. IV-F."""
    substep_s: TimeStep = 0.02
    """Largest integration step. With it RK4 converges to under 0.1 mm over 10 s (see the tests)."""
    loop_s: TimeStep = 0.02
    """Period of the velocity loop: 50 Hz, as in an autopilot."""
    tracking_rate_1_s: Positive = 4.0
    """Decay rate of the velocity error. 0.25 s is several thruster lags; 0.6 m/s stops within 0.2 m."""
    yaw_tracking_rate_1_s: Positive = 4.0
    observer_rate_1_s: float = 4.0
    """Rate at which the loop learns a force that its model does not explain, such as the current's drag. It integrates
    the model's error, not the tracking error, so nothing winds up when the set point steps or a thruster saturates."""


class VehicleDynamics:
    """The simulated vehicle: keeps the state and advances it tick by tick.

    The velocity loop measures ground-relative velocity, as a Doppler log does, and does not know the current. The force
    that it learns is kept in the world frame, where a current stays constant while the vehicle turns.
    """

    def __init__(self, cfg: VehicleCfg | None = None, state: VehicleState | Pose | None = None) -> None:
        self.cfg = cfg = cfg or VehicleCfg()
        self.model = planar(cfg.thrusters, cfg.thrust_max_n)
        if cfg.model not in ("planar", "kinematic"):
            raise InputError("vehicle", "model", cfg.model, "planar or kinematic")
        self.reset(state or VehicleState(0.0, 0.0, 0.0))

    def reset(self, state: VehicleState | Pose) -> None:
        """Set the state, with thrusters at rest. A pose alone means zero velocity."""
        self._s = np.array([*state[:3], *(state[3:] or (0.0, 0.0, 0.0)), 0.0, 0.0, 0.0], dtype=np.float64)
        self._memory = np.array([0.0] * 3 + [math.nan] * 6)

    @property
    def state(self) -> VehicleState:
        """Present pose and ground-relative body velocity."""
        return VehicleState(*self._s[:6].tolist())

    def step(
        self,
        command: tuple[float, float],
        dt: float = 0.1,
        current: tuple[float, float] = (0.0, 0.0),
        contact: Clearance | None = None,
    ) -> NDArray[np.float64]:
        """Move by `dt` seconds under a (forward speed m/s, yaw rate rad/s) command, clipped to the limits.

        The water flows at `current` in the world (m/s). With the distance (m) from a point to the nearest obstacle in
        `contact`, the hull cannot enter obstacles: it is put back on their surface and loses its velocity into them
        (inelastic, frictionless).

        Returns:
            Positions after every integration step, before contacts are resolved, for a collision counter (m).
            Shape=(n_sub, 2).
        """
        cfg = self.cfg
        v_cmd = min(max(command[0], -cfg.max_speed_m_s), cfg.max_speed_m_s)
        omega = min(max(command[1], -cfg.max_yaw_rate_rad_s), cfg.max_yaw_rate_rad_s)
        loops = max(1, round(dt / cfg.loop_s))
        subs = max(1, math.ceil(dt / loops / cfg.substep_s - 1e-9))
        h = dt / loops / subs
        if cfg.model == "kinematic":
            return self._glide(v_cmd, omega, loops * subs, h, contact)
        water, period = np.array(current, dtype=np.float64), dt / loops
        learnt = -math.expm1(-cfg.observer_rate_1_s * period)
        trace = np.empty((loops, subs, 2))
        for positions in trace:
            planar_drive(self._s, self._memory, v_cmd, omega, cfg.tracking_rate_1_s, cfg.yaw_tracking_rate_1_s, period,
                         learnt, self.model, water, cfg.thrusters.lag_s, h, positions)  # fmt: skip
            if contact is not None:
                self._resolve(contact)
        return trace.reshape(-1, 2)

    def _glide(self, v: float, omega: float, count: int, h: float, contact: Clearance | None) -> NDArray[np.float64]:
        """Move exactly as commanded, in `count` steps of `h` seconds. Return the positions (m), Shape=(count, 2)."""
        trace = np.empty((count, 2))
        for k in range(count):
            x, y, theta = advance(float(self._s[0]), float(self._s[1]), float(self._s[2]), v, omega, h)
            self._s[:6] = x, y, math.pi - (math.pi - theta) % (2 * math.pi), v, 0.0, omega
            trace[k] = self._s[:2]
            if contact is not None:
                self._resolve(contact)
        return trace

    def _resolve(self, clearance: Clearance) -> None:
        """Put a hull that has entered an obstacle back on its surface."""
        x, y = self._s[:2]
        depth = self.cfg.hull_radius_m - clearance(x, y)
        if depth <= 0.0:
            return
        e = 1e-3
        normal = np.array([clearance(x + e, y) - clearance(x - e, y), clearance(x, y + e) - clearance(x, y - e)])
        size = float(np.hypot(*normal))
        if size < 1e-9:
            return
        normal /= size
        self._s[:2] += depth * normal
        c, s = math.cos(self._s[2]), math.sin(self._s[2])
        u, v = self._s[3:5]
        velocity = np.array([c * u - s * v, s * u + c * v])
        velocity -= min(0.0, float(velocity @ normal)) * normal
        self._s[3] = c * velocity[0] + s * velocity[1]
        self._s[4] = -s * velocity[0] + c * velocity[1]
