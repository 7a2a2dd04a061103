"""The controllers of the hand by name, those of other packages or of a caller, and what the planner of a run can do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.reactive import ReactiveCfg
from coral.contact.cost.stages import Stage
from coral.contact.scene.observation import HandTarget, Observation
from coral.errors import InputError
from coral.plugins import named_plugin


class HandController(Protocol):
    """A controller of the hand; `Controller` is the one by MPPI.

    Two methods are all: episodes, records, live pages and diagnoses read the `HandPlan` that `plan` returns, of which
    only the targets are necessary.
    """

    def reset(self, now: Observation) -> None:
        """Forget the plan: the hand stands still. Called before the first plan."""

    def plan(
        self,
        now: Observation,
        stage: Stage,
        step: int,
        since: Observation | None = None,
        target: HandTarget | None = None,
        executed: int = 0,
    ) -> HandPlan:
        """Plan the targets of the next control steps; the episode follows the first of them, and plans again.

        `now` is measured, or predicted for the time when the plan will be ready, `step` control steps after the episode
        began. The stage began with `since`; None if it begins now. The hand follows `target` at `now`; None for the one
        of the plan before, of which so many control steps are `executed` then.

        Raises:
            CostError: The stage's cost cannot be evaluated.
        """


MakeHandController = Callable[[PlanningWorld, ControllerCfg, np.random.Generator], HandController]
HAND_CONTROLLERS: dict[str, MakeHandController] = {"mppi": Controller}


def hand_controller_maker(controller: str | MakeHandController, where: str = "controller") -> MakeHandController:
    """Return what makes an episode's controller: given itself, or by the name of ours or of an entry point.

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


@dataclass(frozen=True)
class PlannerLimits:
    """How far, how often and how finely a run plans, and where its hand may go."""

    controller: ControllerCfg
    """Horizon, samples, speeds and workspace of its plans."""
    step_s: float
    """One control step."""
    replan_s: float
    """Simulated time between two plans; conditions of stages are tested at each."""
    late_s: float = 0.0
    """Simulated time that passes while a plan is computed; 0 if the world stands still."""
    press_n: float = ReactiveCfg().force_limit_n
    """The largest force with which the hand presses."""
    arm: bool = False
    """Whether the hand is an arm's, and does not fly."""

    @property
    def horizon_s(self) -> float:
        """Return the time that a plan looks ahead."""
        return self.controller.horizon * self.step_s

    @property
    def free_n(self) -> float | None:
        """Return the force on table and fixtures above which rollouts count as worse; None if none does."""
        return self.controller.press_free_n if self.controller.press_weight else None
