"""What drives the vehicle towards a goal: the low-level planners by name, and those that others bring."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.plugins import named_plugin
from coral.reef.drive.controller import DdpMppi, MppiCfg, Plan
from coral.reef.drive.pd import PdController
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleState


class LocalPlanner(Protocol):
    """Drives towards a goal: DDP-MPPI, or a baseline in its place."""

    def plan(
        self, state: VehicleState, cost_field: CostField, distance_map: NDArray[np.float32], *, cell_m: float = 0.05
    ) -> Plan:
        """Command for the next tick, from the cost-to-go and the distances (m) to known obstacles."""

    def reset(self) -> None:
        """Forget the previous plan: the vehicle has stood still since."""


@dataclass(frozen=True, kw_only=True)
class ControllerSetup:
    """What a controller is made from."""

    cfg: MppiCfg
    """Configuration of DDP-MPPI, `--cfg.controller`."""
    vehicle: VehicleCfg
    """The vehicle: its limits and dynamics."""
    rng: np.random.Generator
    """Random generator of this robot's controller."""
    control_period_s: float
    """Time between two calls of `plan`."""
    response: VehicleResponse | None = None
    """How the vehicle follows its set-points; None: at once, as the simulated one does."""


MakeController = Callable[[ControllerSetup], LocalPlanner]


CONTROLLERS: dict[str, MakeController] = {
    "ddp-mppi": lambda setup: DdpMppi(
        setup.cfg, setup.vehicle, setup.rng, control_period_s=setup.control_period_s, response=setup.response
    ),
    "pd": lambda setup: PdController(vehicle=setup.vehicle),
}


def controller_maker(controller: str | MakeController, where: str = "--cfg", field: str = "driver") -> MakeController:
    """Return the function that makes a robot's controller: given itself, or the name of one of ours or an entry point.

    Raises:
        InputError: There is no controller of this name.
    """
    if not isinstance(controller, str):
        if not callable(controller):
            raise InputError(where, field, repr(controller), "a function of a ControllerSetup that makes a controller")
        return controller
    if controller in CONTROLLERS:
        return CONTROLLERS[controller]
    made: MakeController = named_plugin("coral.controllers", controller, where, field, list(CONTROLLERS))
    return made


def part_name(part: Any) -> str:
    """Return the name of an exchanged part for the record: its own, or that of its class or function."""
    if isinstance(part, str):
        return part
    named = getattr(part, "name", None) or getattr(part, "__qualname__", None) or type(part).__qualname__
    return str(named)
