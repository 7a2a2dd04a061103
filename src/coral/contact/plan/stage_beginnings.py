"""Where the later stages of a plan begin: the planning world follows the plan for some seconds, with few samples.

A later stage that is judged in the opening scene is judged wrongly: an object that is to be pressed on where it lies
still stands there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from coral.config import Count, Positive
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.prediction import state_after
from coral.contact.cost.stages import Progress, Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.scene.observation import Observation
from coral.mppi.knots import KnotMppiCfg

SEED = 20_261
"""The same samples at every call: one plan has one rehearsal."""


@dataclass(frozen=True, kw_only=True)
class BeginningsCfg:
    """Length and effort of the rehearsal."""

    most_s: Positive = 6.0
    """Simulated time."""
    replan_steps: Count = 4
    """Control steps between two plans."""
    controller: ControllerCfg = field(
        default_factory=lambda: replace(ControllerCfg(), mppi=replace(KnotMppiCfg(), samples=16))
    )
    """The planner, with few samples: where a stage begins is to be known to a centimetre or two."""


def stage_beginnings(
    world: PlanningWorld, strategy: Strategy, now: Observation, wanted: Sequence[str], cfg: BeginningsCfg | None = None
) -> dict[str, Observation]:
    """Return the states in which stages begin when the plan is followed in the planning world.

    Args:
        world: The planning world with its beliefs.
        strategy: The plan.
        now: The present state.
        wanted: Names of the stages; the rehearsal ends once all have begun.
        cfg: Length and effort.

    Returns:
        By name, the state in which a stage first begins; stages that are not reached are missing.
    """
    cfg = cfg or BeginningsCfg()
    controller = Controller(world, cfg.controller, np.random.default_rng(SEED))
    progress, found = Progress(strategy), {strategy.stages[0].name: now}
    steps = round(cfg.most_s / world.cfg.step_s)
    try:
        for step in range(0, steps, cfg.replan_steps):
            stage = progress.stage
            plan = controller.plan(now, stage, step)
            if not plan.update.ok:
                break
            if progress.update(plan.now):
                found.setdefault(progress.stage.name, now)
                if all(name in found for name in wanted):
                    break
            now = state_after(world, now, plan.targets[: cfg.replan_steps], step)
            controller.executed(plan.targets[cfg.replan_steps - 1], cfg.replan_steps)
    except CostError:
        pass  # the stages that were reached before have begun nevertheless
    return found
