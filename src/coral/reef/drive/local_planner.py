"""The interface of what drives the vehicle towards a goal."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.reef.drive.controller import Plan
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.vehicle import VehicleState


class LocalPlanner(Protocol):
    """Drives towards a goal: DDP-MPPI, or a baseline in its place."""

    def plan(
        self, state: VehicleState, cost_field: CostField, distance_map: NDArray[np.float32], *, cell_m: float = 0.05
    ) -> Plan:
        """Command for the next tick, from the cost-to-go and the distances (m) to known obstacles."""

    def reset(self) -> None:
        """Forget the previous plan: the vehicle has stood still since."""
