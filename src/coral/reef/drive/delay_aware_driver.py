"""Planning for a vehicle that obeys late: from the state in which the next command will find it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.drive.controller import DdpMppi, Plan
from coral.reef.drive.controllers import LocalPlanner
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.response import DelayedCommands, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleState


class DelayAwareDriver:
    """A planner that gets the predicted state in place of the present one; DDP-MPPI also what trails behind."""

    def __init__(
        self, driver: LocalPlanner, response: VehicleResponse, most_m_s: float, control_period_s: float = 0.1
    ) -> None:
        """Wrap a planner; `most_m_s` is the largest forward speed that is asked for."""
        self.driver, self._most_m_s = driver, most_m_s
        self._under_way = DelayedCommands(response, control_period_s)

    def plan(
        self, state: VehicleState, cost_field: CostField, distance_map: NDArray[np.float32], *, cell_m: float = 0.05
    ) -> Plan:
        """Plan from the time when the command begins to act; poses of the plan count from there."""
        trailing = self._under_way.trailing(state, self._most_m_s)
        ahead, trailing = self._under_way.predict(state, trailing)
        if isinstance(self.driver, DdpMppi):
            return self.driver.plan(ahead, cost_field, distance_map, cell_m=cell_m, trailing=trailing)
        return self.driver.plan(ahead, cost_field, distance_map, cell_m=cell_m)

    def reset(self) -> None:
        """Forget the previous plan; what was sent is known from `note`."""
        self.driver.reset()

    def note(self, command: tuple[float, float]) -> None:
        """Remember the command (m/s, rad/s) that was given in this tick, zero while the vehicle stands."""
        self._under_way.note(command)
