"""The proportional-derivative controller of the ablation without a low-level planner. It ignores map and obstacles."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.drive.controller import NOT_FINITE, Plan
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleState
from coral.reef.world.geometry import wrap

SURGE_KP_N_M, SURGE_KD_NS_M = 20.0, 26.0
YAW_KP_NM_RAD, YAW_KD_NMS_RAD = 2.4, 2.4
"""Gains (the paper gives none): critically damped with the planar masses, 1 rad/s in surge and 2 rad/s in yaw."""
HOLD_M = 0.3
HORIZON_S = 5.0
"""Duration of the straight line in `Plan.path`. The control law itself does not look ahead."""


class PdController:
    """Drives straight at the goal. It is called like `DdpMppi`.

    The law Kp e - Kd nu has the cascade form Kd (Kp/Kd e - nu): the set point Kp/Kd e goes to the vehicle's velocity
    loop, so both controllers share thrusters, limits and drag compensation.
    """

    def __init__(self, vehicle: VehicleCfg | None = None) -> None:
        self.vehicle = vehicle or VehicleCfg()

    def reset(self) -> None:
        """Do nothing: there is no state to reset."""

    def plan(
        self,
        state: VehicleState,
        cost_field: CostField,
        distance_map: NDArray[np.float32] | None = None,
        *,
        cell_m: float = 0.05,
    ) -> Plan:
        """Compute the command towards `cost_field.goal`. The field's values and the map are ignored."""
        if not all(map(math.isfinite, state)):
            return Plan((0.0, 0.0), False, NOT_FINITE, np.zeros((11, 3)))
        dx, dy = cost_field.goal[0] - state.x, cost_field.goal[1] - state.y
        distance = math.hypot(dx, dy)
        bearing = wrap(math.atan2(dy, dx) - state.theta)
        v = omega = 0.0
        if distance > HOLD_M:
            v_max, w_max = self.vehicle.max_speed_m_s, self.vehicle.max_yaw_rate_rad_s
            # The error along the body's x axis. The vehicle turns to a goal behind it and does not reverse.
            v = min(max(SURGE_KP_N_M / SURGE_KD_NS_M * distance * math.cos(bearing), 0.0), v_max)
            omega = min(max(YAW_KP_NM_RAD / YAW_KD_NMS_RAD * bearing, -w_max), w_max)
        along = np.minimum(v * np.linspace(0.0, HORIZON_S, 11), distance)[:, None] / max(distance, 1e-9)
        heading = np.full((11, 1), math.atan2(dy, dx))
        path = np.hstack([(state.x, state.y) + along * (dx, dy), heading])
        return Plan((v, omega), True, "", path)
