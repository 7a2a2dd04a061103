"""Choice of a remembered plan: adapted in two ways, checked like any answer, and rehearsed in the planning world."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from coral.advisor.question import Rejection
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.cost_program import CostError
from coral.contact.memory.adaptation import adapt
from coral.contact.memory.memory import Match, Memory
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import Loader, PlanAnswer, make_strategy
from coral.contact.plan.imagined_outcome import ImaginedOutcome, imagined_outcome
from coral.contact.plan.imagined_run import imagine
from coral.contact.plan.rehearsal import rehearsed_gain
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.observation import Observation
from coral.contact.scene.trial import Trial
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.think_cfg import ThinkCfg


@dataclass(frozen=True)
class RecalledPlan:
    """A remembered plan, adapted to the scene."""

    match: Match
    """Its experience."""
    plan: PlanAnswer
    regions: RegionsAnswer
    scaled: bool
    """Whether lengths that were sizes or places were computed anew."""
    refusal: Rejection | None = None
    """Why it is not followed."""
    gain: float = 0.0
    """Share by which the best rehearsed motion lowers the cost of its first stage."""
    outcome: ImaginedOutcome | None = None
    """How far it came in its rehearsal; None if there was none."""
    strategy: Strategy | None = field(default=None, compare=False, repr=False)
    """What the planner would follow; None before it passed the checks of its programs."""


class Recall:
    """Chooses among remembered plans at the start of an episode.

    Args:
        questions: Facts of the scene and the checks of answers.
        trial: The trial as perceived.
        world: The planning world.
        cfg: Configuration of the outer loop.
        rng: Samples the motions of the check.
        load: Loads programs into the confined process.
    """

    def __init__(
        self,
        questions: Questions,
        trial: Trial,
        world: PlanningWorld,
        cfg: ThinkCfg,
        rng: np.random.Generator,
        load: Loader,
    ) -> None:
        self._questions, self._trial, self._world = questions, trial, world
        self._cfg, self._rng, self._load = cfg, rng, load

    def choose(self, memory: Memory, first: Observation, emit: Callable[..., None]) -> RecalledPlan | None:
        """Return the plan to follow; None if no remembered plan passes its checks. Report each as a `recall` event.

        Args:
            memory: The memory.
            first: The first observation.
            emit: The run's log.
        """
        tried: list[RecalledPlan] = []
        passed: list[RecalledPlan] = []
        for adapted in adaptations(memory, self._questions.facts):
            checked = self._check(adapted, first)
            tried.append(checked)
            passed += [checked] if checked.refusal is None else []
            if len(passed) == self._cfg.memory.rehearsed:
                break
        chosen = None
        if passed:
            rated = passed if len(passed) == 1 else [replace(one, outcome=self._rehearse(one, first)) for one in passed]
            # Of equal ones the first: the better match, and lengths computed anew.
            chosen = max(rated, key=lambda one: one.outcome or ImaginedOutcome(False, 0.0, 0.0, 0.0))
            for one in rated:
                tried[next(k for k, each in enumerate(tried) if each.plan is one.plan)] = one
        for one in tried:
            self._report(one, one is chosen, memory, emit)
        return chosen

    def _report(self, one: RecalledPlan, chosen: bool, memory: Memory, emit: Callable[..., None]) -> None:
        refused = "" if one.refusal is None else one.refusal.reason
        if not refused and not chosen:
            refused = "another remembered plan came further in its rehearsal"
        stored = one.match.stored
        emit(
            "recall",
            id=stored.id,
            similarity=one.match.similarity,
            distance=one.match.distance,
            embedder=memory.embedder.name,
            used=stored.used,
            helped=stored.helped,
            lengths="computed anew" if one.scaled else "as they were",
            gain=round(one.gain, 4),
            outcome=None if one.outcome is None else {key: round(v, 3) for key, v in asdict(one.outcome).items()},
            refused=refused,
            **({"decided": "plan", "source": "memory"} if chosen else {}),
        )

    def _check(self, one: RecalledPlan, first: Observation) -> RecalledPlan:
        refusal = self._questions.check_plan(one.plan, first, self._load)
        if refusal is None and self._cfg.regions:
            refusal = self._questions.check_regions(one.regions, one.plan)
        gain, strategy = 0.0, None
        if refusal is None:
            try:
                strategy = self._strategy(one)
                gain = rehearsed_gain(self._world, strategy.stages[0], first, self._questions.sizes, self._rng)
            except CostError as error:
                refusal = Rejection(code=error.code, reason=str(error))
        if refusal is None and gain < self._cfg.least_gain:
            refusal = Rejection(code="rehearsal", reason=f"rehearsed, it lowers the cost by {100 * gain:.0f} %")
        return replace(one, refusal=refusal, gain=gain, strategy=strategy)

    def _rehearse(self, one: RecalledPlan, first: Observation) -> ImaginedOutcome:
        assert one.strategy is not None
        moments = list(imagine(self._world, one.strategy, first))
        return imagined_outcome(self._trial, moments, one.plan.names)

    def _strategy(self, one: RecalledPlan) -> Strategy:
        regions = one.regions if self._cfg.regions else None
        points = None if regions is None else self._questions.touchable_candidates(regions, one.plan)
        sizes = self._questions.sizes
        return make_strategy("rehearsal", one.plan, regions, self._world.schema, sizes, self._load, candidates=points)


def adaptations(memory: Memory, facts: SceneFacts) -> Iterator[RecalledPlan]:
    """Yield the remembered plans that match, the best first: each with its lengths computed anew, then as they were."""
    for match in memory.find(facts):
        held = match.stored.experience
        plan, regions = adapt(held, facts, match.goals)
        yield RecalledPlan(match, plan, regions, scaled=True)
        other, _ = adapt(held, facts, match.goals, scaled=False)
        if other != plan:
            yield RecalledPlan(match, other, regions, scaled=False)
