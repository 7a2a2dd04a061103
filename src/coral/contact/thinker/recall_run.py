"""The imagined run of a remembered plan: followed in the planning world for as long as it gets somewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.plan.imagined_outcome import ImaginedJudge, ImaginedOutcome
from coral.contact.plan.imagined_run import imagine
from coral.contact.scene.observation import Observation
from coral.contact.scene.trial import Trial
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.strategist import PlanReport
from coral.mppi.knots import KnotMppiCfg

MOST_RETURNS = 2
"""Returns to an earlier stage after which the diagnosis says `slipped`."""

CONTROLLER = replace(ControllerCfg(), mppi=KnotMppiCfg(samples=16))
"""The planner: few samples, drawn as the inner loop draws them. With equal noise, good plans did not
leave their first stage."""


@dataclass(frozen=True)
class RecallRun:
    """What the imagined run of a remembered plan showed."""

    outcome: ImaginedOutcome
    """How far the plan came."""
    length_s: float
    """Imagined time."""
    refusal: str
    """Why the plan is not to be followed; "" if it may be."""


def try_recalled(
    world: PlanningWorld,
    trial: Trial,
    strategy: Strategy,
    names: Sequence[str],
    first: Observation,
    cfg: OuterCfg,
    repaired: bool = False,
) -> RecallRun:
    """Follow a remembered plan in the planning world until its fate is clear.

    That is when it succeeds, when it breaks something for good, when it has fallen back to an earlier stage twice, when
    the outer loop would call it stuck, or at the task's time limit. Refused is a plan that breaks something or falls
    back twice, one of several stages that never leaves its first, and one of a single stage that never meets a
    condition of success more than at the beginning. Less is no evidence against a plan: under wrong masses and
    frictions, or with so few samples, a good one may end without success in imagination. A plan that succeeded after a
    repair was stuck then too: it is refused only for what it breaks.
    """
    judge, monitor = ImaginedJudge(trial, names), ProgressMonitor(cfg, tuple(names))
    end_s = first.time_s
    for moment in imagine(world, strategy, first, trial.task.time_limit_s, CONTROLLER):
        judge.update(moment)
        end_s = moment.now.time_s
        stuck = monitor.update(PlanReport(moment.now, moment.plan, moment.stage))
        if judge.succeeded or judge.broken or stuck or monitor.returns == MOST_RETURNS:
            break
    return RecallRun(judge.outcome, round(end_s - first.time_s, 2), _refusal(judge, monitor, len(names), repaired))


def _refusal(judge: ImaginedJudge, monitor: ProgressMonitor, count: int, repaired: bool) -> str:
    begun = round(judge.outcome.stages * count)
    if judge.succeeded:
        return ""
    if judge.broken:
        return f"in an imagined run, it breaks for good: {', '.join(judge.broken)}"
    if repaired:
        return ""
    if monitor.returns == MOST_RETURNS:
        return f"in an imagined run, it fell back to an earlier stage {MOST_RETURNS} times"
    if begun == 1 < count:
        return f"in an imagined run, it never left its first stage, {monitor.stage!r}"
    if count == 1 and not judge.gained:
        return "in an imagined run, it met no condition of success that was not met before"
    return ""
