"""A plan followed in the planning world, before the robot moves: the control loop with few samples, in imagination."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.prediction import observation_of, states_under
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress, Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.scene.observation import Observation
from coral.mppi.knots import KnotMppiCfg

SEED = 20_261
"""The same samples at every call: one plan has one imagined run."""


REPLAN_STEPS = 4
"""Control steps between two plans."""
MOST_S = 6.0
"""Simulated time in which the beginnings of stages are looked for."""
CONTROLLER = replace(ControllerCfg(), mppi=KnotMppiCfg(samples=16, fine=0.0, spread_quantile=0.9))
"""The planner for that: where a stage begins is to be known to a centimetre or two. So few samples get further with
equal noise than with fine ones."""


@dataclass(frozen=True, eq=False)
class ImaginedMoment:
    """The moment of one plan."""

    now: Observation
    """The state for which the plan was made."""
    stage: str
    next_stage: str
    """The active stage after the conditions were tested: the same one, the next one, or one that it falls back to."""
    plan: HandPlan
    """The plan; its `now` holds the quantities of the state, the contacts too."""
    after: Context | None = None
    """The states after each control step until the next moment, Shape=(1, n); None if this motion diverges."""


def imagine(
    world: PlanningWorld, strategy: Strategy, now: Observation, most_s: float, cfg: ControllerCfg
) -> Iterator[ImaginedMoment]:
    """Follow a plan in the planning world, under the best belief.

    The run ends after `most_s`, when no rollout is valid, or when a cost cannot be evaluated.
    """
    controller = Controller(world, cfg, np.random.default_rng(SEED))
    progress, since, latest = Progress(strategy), now, None
    for step in range(0, round(most_s / world.cfg.step_s), REPLAN_STEPS):
        stage = progress.stage
        try:
            plan = controller.plan(now, stage, step, since, latest, REPLAN_STEPS if latest else 0)
            if not plan.valid or plan.now is None:
                return
            if progress.update(plan.now):
                since = now
        except CostError:
            return
        after = states_under(world, now, plan.targets[:REPLAN_STEPS], step)
        yield ImaginedMoment(now, stage.name, progress.stage.name, plan, after)
        now = now if after is None else observation_of(after, now)
        latest = plan.targets[REPLAN_STEPS - 1]


def stage_beginnings(
    world: PlanningWorld, strategy: Strategy, now: Observation, wanted: Sequence[str]
) -> dict[str, Observation]:
    """Return the states in which stages first begin when the plan is followed until all that are wanted have begun.

    Stages that are not reached are missing.
    """
    found = {strategy.begin or strategy.stages[0].name: now}
    for moment in imagine(world, strategy, now, MOST_S, CONTROLLER):
        found.setdefault(moment.next_stage, moment.now)
        if all(name in found for name in wanted):
            break
    return found
