"""Where the later stages of a plan begin when the planning world follows the plan.

A later stage that is judged in the opening scene is judged wrongly: an object that is to be pressed on where it lies
still stands there.
"""

from __future__ import annotations

from collections.abc import Sequence

from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.plan.imagined_run import ImaginedRunCfg, imagine
from coral.contact.scene.observation import Observation


def stage_beginnings(
    world: PlanningWorld, strategy: Strategy, now: Observation, wanted: Sequence[str], cfg: ImaginedRunCfg | None = None
) -> dict[str, Observation]:
    """Return the states in which stages begin when the plan is followed in the planning world.

    Args:
        world: The planning world with its beliefs.
        strategy: The plan.
        now: The present state.
        wanted: Names of the stages; the run ends once all have begun.
        cfg: Length and effort.

    Returns:
        By name, the state in which a stage first begins; stages that are not reached are missing.
    """
    found = {strategy.begin or strategy.stages[0].name: now}
    for moment in imagine(world, strategy, now, cfg):
        found.setdefault(moment.next_stage, moment.now)
        if all(name in found for name in wanted):
            break
    return found
