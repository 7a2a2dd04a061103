"""Choice of a remembered plan: adapted in two ways, checked like any answer, and tried in an imagined run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.cost_program import CostError
from coral.contact.memory.adaptation import adapt
from coral.contact.memory.memory import Match, Memory, RememberedPlan
from coral.contact.plan.cost_plan import make_strategy
from coral.contact.plan.imagined_run import ImaginedJudge, ImaginedOutcome, imagine
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.observation import Observation
from coral.contact.scene.trial import Trial
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.strategist import PlanReport
from coral.contact.thinker.think_cfg import ThinkCfg
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


NOTHING = ImaginedOutcome(False, 0.0, 0.0, 0.0)
"""Outcome of a plan that was not tried."""


@dataclass(frozen=True)
class RecalledPlan:
    """A remembered plan, adapted to the scene."""

    match: Match
    steps: tuple[RememberedPlan, ...]
    """The plan, and its repairs."""
    refusal: str = ""
    """Why it is not followed."""
    run: RecallRun | None = None
    """Its imagined run, if there was one."""
    strategy: Strategy | None = field(default=None, compare=False, repr=False)
    """What the planner would follow; None before it passed the checks of its programs."""


class Recall:
    """Chooses among remembered plans at the start of an episode."""

    def __init__(self, questions: Questions, trial: Trial, world: PlanningWorld, cfg: ThinkCfg) -> None:
        self._questions, self._trial, self._world, self._cfg = questions, trial, world, cfg

    def choose(self, memory: Memory, first: Observation, emit: Callable[..., None]) -> RecalledPlan | None:
        """Return the plan to follow; None if no remembered plan may be followed. Report each as a `recall` event.

        The first that succeeds in its imagined run, or comes through all its stages there without being refused, is
        followed: under guessed masses and frictions, a run tells no more. If none does, it is the one that came
        furthest of those that are not refused.
        """
        most, runs = self._cfg.memory.rehearsed, 0
        tried: list[RecalledPlan] = []
        for adapted in adaptations(memory, self._questions.facts):
            one = self._check(adapted, first)
            if not one.refusal and most:
                if runs == most:
                    break
                one, runs = self._try(one, first), runs + 1
            tried.append(one)
            if not one.refusal and (one.run is None or one.run.outcome.stages == 1.0):
                break
        passed = [one for one in tried if not one.refusal]
        # Of equal ones the first: the better match.
        chosen = max(passed, key=lambda one: NOTHING if one.run is None else one.run.outcome, default=None)
        for one in tried:
            self._report(one, one is chosen, memory, emit)
        return chosen

    def _report(self, one: RecalledPlan, chosen: bool, memory: Memory, emit: Callable[..., None]) -> None:
        refused = one.refusal
        if not refused and not chosen:
            refused = "another remembered plan came further in its imagined run"
        stored, run = one.match.stored, one.run
        emit(
            "recall",
            id=stored.id,
            similarity=one.match.similarity,
            distance=one.match.distance,
            used=stored.used,
            helped=stored.helped,
            rehearsed_s=0.0 if run is None else run.length_s,
            outcome=None if run is None else {key: round(v, 3) for key, v in asdict(run.outcome).items()},
            refused=refused,
            **({"decided": "plan", "source": "memory"} if chosen else {}),
        )

    def _check(self, one: RecalledPlan, first: Observation) -> RecalledPlan:
        """Make the strategy of a plan that passes the checks of any answer."""
        questions, begun = self._questions, one.steps[0]
        regions = begun.regions if self._cfg.regions else None
        refusal = questions.check_plan(begun.plan, first, remembered=True)
        if refusal is None and regions is not None:
            refusal = questions.check_regions(regions, begun.plan)
        if refusal is not None:
            return replace(one, refusal=refusal.reason)
        points = [] if regions is None else questions.touchable_candidates(regions, begun.plan)
        schema, sizes, load = self._world.schema, questions.sizes, questions.load
        try:
            return replace(
                one, strategy=make_strategy("imagined", begun.plan, regions, schema, sizes, load, candidates=points)
            )
        except CostError as error:
            return replace(one, refusal=str(error))

    def _try(self, one: RecalledPlan, first: Observation) -> RecalledPlan:
        assert one.strategy is not None
        names, repaired = one.steps[0].plan.names, len(one.steps) > 1
        found = try_recalled(self._world, self._trial, one.strategy, names, first, self._cfg.outer, repaired)
        return replace(one, refusal=found.refusal, run=found)


def adaptations(memory: Memory, facts: SceneFacts) -> Iterator[RecalledPlan]:
    """Yield the remembered plans that match, the best first, adapted to the scene.

    One author writes the same plan more than once: equal ones are yielded once.
    """
    seen: list[tuple[RememberedPlan, ...]] = []
    for match in memory.find(facts):
        steps = adapt(match.stored.experience, facts, match.goals)
        if steps not in seen:
            seen.append(steps)
            yield RecalledPlan(match, steps)
