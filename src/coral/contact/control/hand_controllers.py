"""The controllers of the hand by name, and those that other packages or a caller bring."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from coral.contact.control.mppi_controller import Controller, ControllerCfg, HandPlan
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Stage
from coral.contact.scene.observation import HandTarget, Observation
from coral.errors import InputError
from coral.plugins import named_plugin


class HandController(Protocol):
    """Interface of a controller of the hand; `Controller` is the one by MPPI."""

    def plan(self, now: Observation, stage: Stage, step: int, since: Observation | None = None) -> HandPlan:
        """Plan from the measured state; see `Controller.plan`."""
        ...

    def executed(self, target: HandTarget, steps: int) -> None:
        """Take note of the last command and the number of executed steps."""
        ...


MakeHandController = Callable[[PlanningWorld, ControllerCfg, np.random.Generator], HandController]
HAND_CONTROLLERS: dict[str, MakeHandController] = {"mppi": Controller}


def hand_controller_maker(controller: str | MakeHandController, where: str = "controller") -> MakeHandController:
    """Return the function that makes an episode's controller.

    Args:
        controller: Name of ours or of an entry point of the group `coral.hand_controllers`, or the function itself.
        where: Flag or argument, for the error.

    Raises:
        InputError: There is no controller of this name.
    """
    if not isinstance(controller, str):
        if not callable(controller):
            raise InputError(where, "", repr(controller), "a function that makes a controller of the hand")
        return controller
    if controller in HAND_CONTROLLERS:
        return HAND_CONTROLLERS[controller]
    made: MakeHandController = named_plugin("coral.hand_controllers", controller, where, ours=list(HAND_CONTROLLERS))
    return made
