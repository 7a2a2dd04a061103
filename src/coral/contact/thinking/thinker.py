"""CoRAL's mind: beliefs, a plan from memory or from the advisor, regions, and refinement when stuck (Fig. 2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from coral.advisor.consult import Outcome
from coral.advisor.question import AdvisorUnavailable, Rejection
from coral.contact.context import Cost
from coral.contact.draw import Drawn, Physical
from coral.contact.mind import Account, Moment, NoStrategy, Step
from coral.contact.planning import PlanningWorld
from coral.contact.program import CostError, LastGoodCost
from coral.contact.scene import prior
from coral.contact.sight import Look, picture
from coral.contact.strategy import Strategy
from coral.contact.thinking.ask import Asker
from coral.contact.thinking.beliefs import Estimates, belief_prompt, verify_estimates
from coral.contact.thinking.correct import Past, correct
from coral.contact.thinking.history import most_telling
from coral.contact.thinking.locate import ask_poses
from coral.contact.thinking.memory import Experience, Match, Memory, scene_numbers
from coral.contact.thinking.outer import Watch
from coral.contact.thinking.plan_answer import Loader, PlanAnswer, in_process, make_strategy, verify_plan
from coral.contact.thinking.recall import adapted
from coral.contact.thinking.regions import RegionsAnswer, verify_regions
from coral.contact.thinking.rehearse import gain, sample_states
from coral.contact.thinking.repair import TEXTS, Diagnosis, diagnose, recent
from coral.contact.thinking.rhythm import Rhythm
from coral.contact.thinking.rules import RULES
from coral.contact.thinking.scene_facts import interface_text, scene_facts
from coral.contact.thinking.think_cfg import ThinkCfg
from coral.contact.thinking.unified import ask_all
from coral.contact.world import Body, Observation
from coral.errors import RunError


class Thinker:
    """Decides by asking, remembers what succeeded, corrects what fails.

    Args:
        asker: The advisor.
        cfg: What is on.
        rng: Draws samples for checks and fits.
        memory: Of successes; None for none.
        load: How cost programs are made: in this process, or in the confined one.
        provenance: For what is stored: world, seed, variant, advisor.
        given: What is believed of objects at first, whatever the advisor would estimate.
    """

    def __init__(self, asker: Asker, cfg: ThinkCfg, rng: np.random.Generator, memory: Memory | None = None,
                 load: Loader = in_process, provenance: Mapping[str, Any] | None = None,
                 given: Mapping[str, Physical] | None = None) -> None:
        self.asker, self.cfg, self.memory = asker, cfg, memory
        self._rng, self._load, self._provenance = rng, load, dict(provenance or {})
        self._emit: Callable[..., None] = lambda event, **fields: None
        self._given = dict(given or {})
        self._rhythm = Rhythm(cfg.correct_every_s if cfg.refine and not cfg.unified else 0.0, cfg.corrections)
        self._now: Observation
        self._repairs = 0
        self._hit: Match | None = None
        self._unanswered = ""
        self._diagnoses: list[Diagnosis] = []
        self._past: list[Step] = []
        self._sizes: dict[str, np.ndarray] = {}
        self._drawn: Drawn
        self._world: PlanningWorld
        self._plan: PlanAnswer
        self._regions = RegionsAnswer({})
        self._facts: dict[str, Any] = {}
        self._watch: Watch
        self._failure: CostError | None = None
        self._keep = self._keeping()
        self._look: Look = lambda: None

    @property
    def account(self) -> Account:
        """See `Mind.account`."""
        return Account(self.asker.calls, self._repairs, self._hit is not None)

    def listen(self, emit: Callable[..., None]) -> None:
        """See `Mind.listen`."""
        self._emit = emit

    @property
    def guesses(self) -> bool:
        """See `Mind.guesses`."""
        return not self.cfg.tracking

    def open_eyes(self, look: Look) -> None:
        """See `Mind.open_eyes`."""
        self._look = look
        self.asker.pictures = lambda: tuple(picture(frame) for frame in (look(),) if frame is not None)

    def locate(self, drawn: Drawn, first: Observation) -> dict[str, Body]:
        """See `Mind.locate`."""
        frame = self._look()
        if frame is None:
            raise RunError("poses cannot be guessed in a world without pictures")
        return ask_poses(self.asker, drawn, first, frame, self._emit)

    def begin(self, drawn: Drawn, first: Observation, world: PlanningWorld) -> Strategy:
        """Perceive, recall or ask, check, and make the strategy."""
        self._drawn, self._world = drawn, world
        self._sizes = {name: drawn.size(name) for name in drawn.objects}
        if self.cfg.unified:
            self._facts = scene_facts(drawn, first)
            self._plan = self._ask_all(first) or self._rule()
        else:
            self._believe_first(first)
            self._facts = scene_facts(drawn, first, self._beliefs)
        strategy = self._strategy("asked") if self.cfg.unified else self._recall(first)
        if strategy is None:
            self._plan = self._ask_plan("cost-function", first, self._plan_prompt()) or self._rule()
            self._regions = self._ask_regions(first)
            strategy = self._strategy("asked")
        self._watch = Watch(self.cfg.outer, tuple(self._plan.names))
        return strategy

    def after(self, moment: Moment) -> Strategy | None:
        """Watch the progress; think again when there is none, or when a cost failed and the last good one took over.

        Raises:
            CostError: See `Mind.after`.
        """
        self._past += moment.taken
        self._now = moment.now
        failure, self._failure = self._failure, None
        if failure is not None:
            strategy = self._mend(failure, moment.stage, moment.now, self._keep.name)
            if strategy is None:
                raise failure
            return strategy
        if self._watch.see(moment) and self.cfg.refine and self._repairs < self.cfg.outer.refinements:
            return self._refine(moment)
        self._correct_in_passing()
        return None

    def failed(self, error: CostError, stage: str, now: Observation) -> Strategy | None:
        """Have a cost repaired that failed while it was in use, as often as the outer loop may think again."""
        return self._mend(error, stage, now, "")

    def _mend(self, error: CostError, stage: str, now: Observation, meanwhile: str) -> Strategy | None:
        self._emit("cost_error", stage=stage, code=error.code, reason=str(error), meanwhile=meanwhile)
        if not self.cfg.refine or self._repairs >= self.cfg.outer.refinements:
            return None
        self._repairs += 1
        self._failure = None
        self._diagnoses.append("cost-error")
        self._facts = {**scene_facts(self._drawn, now, self._beliefs), "refused": 0}
        try:
            self._replan(now, self._rule, f"in stage {stage!r}, {error}")
        except NoStrategy:
            return None
        return self._repaired()

    def ended(self, reason: str) -> None:
        """Keep what succeeded; note whether what was remembered helped."""
        success = reason == "success"
        self._correct_in_passing(last=True)
        if self._hit is not None and self.memory is not None:
            self.memory.used(self._hit.stored.id, success)
        elif success and self.memory is not None and self._facts:
            number = self.memory.add(self._experience())
            self._emit("remembered", id=number, file=self.memory.path.name)
        self.asker.close()

    @property
    def _beliefs(self) -> dict[str, Physical]:
        return dict(self._world.beliefs[0])

    def _believe_first(self, first: Observation) -> None:
        if set(self._given) >= set(self._sizes):
            self._world.believe(self._given)
            self._emit("beliefs", source="given", attempts=0, refused=[], **_told(self._given))
            return
        facts = scene_facts(self._drawn, first)
        outcome = self.asker.ask(
            "physical-parameters", Estimates, facts, belief_prompt(facts),
            lambda answer: verify_estimates(answer, {name: list(size) for name, size in self._sizes.items()},
                                            self.cfg.belief), seen=True)
        beliefs = {**(prior(self._drawn) if outcome.answer is None else outcome.answer.physical()), **self._given}
        self._world.believe(beliefs)
        source = "given" if self._given else outcome.failure or "advisor"
        self._emit("beliefs", source=source, attempts=outcome.attempts,
                   refused=[rejection.reason for rejection in outcome.rejections], **_told(beliefs))

    def _recall(self, first: Observation) -> Strategy | None:
        if self.memory is None:
            return None
        for match in self.memory.find(self._facts):
            plan, regions = adapted(match.stored.experience, self._facts)
            refusal = self._wrong_plan(plan, first) or verify_regions(regions, self._facts, plan.names, self.cfg.region)
            risen = 0.0
            if refusal is None:
                self._plan, self._regions = plan, regions
                self._keep = self._keeping()
                strategy = self._strategy(f"remembered {match.stored.id}")
                risen = gain(self._world, strategy.stages[0], first)
                if risen < self.cfg.least_gain:
                    refusal = Rejection(code="rehearsal",
                                        reason=f"rehearsed, it lowers the cost by {100 * risen:.0f} %")
            self._emit("recall", id=match.stored.id, similarity=match.similarity, distance=match.distance,
                       embedder=self.memory.embedder.name, gain=round(risen, 4),
                       refused="" if refusal is None else refusal.reason)
            if refusal is None:
                self._hit = match
                return strategy
        return None

    def _wrong_plan(self, plan: PlanAnswer, now: Observation) -> Rejection | None:
        samples = sample_states(self._world, now, self._sizes, self._rng)
        return verify_plan(plan, self._world.schema, samples, self._load)

    def _ask_plan(self, kind: str, now: Observation, prompt: Mapping[str, Any]) -> PlanAnswer | None:
        facts = self._asked()
        outcome = self.asker.ask(kind, PlanAnswer, facts, prompt, lambda plan: self._wrong_plan(plan, now))
        self._facts["refused"] = len(outcome.rejections)
        self._tell_plan(kind, outcome)
        self._unanswered = outcome.failure
        return outcome.answer

    def _tell_plan(self, kind: str, outcome: Outcome[Any]) -> None:
        plan: PlanAnswer | None = outcome.answer
        self._emit("plan_answer", kind=kind, failure=outcome.failure, attempts=outcome.attempts,
                   refused=[rejection.reason for rejection in outcome.rejections],
                   explanation="" if plan is None else plan.explanation, code="" if plan is None else plan.text())

    def _rule(self) -> PlanAnswer:
        # Without an answer the rules take over, and the record says so: a robot that stands still helps nobody.
        try:
            rule = RULES["cost-function"](self._asked(), ())
        except AdvisorUnavailable as none:
            raise NoStrategy(none.reason) from None
        assert isinstance(rule, PlanAnswer)
        self._emit("fallback", what="plan", by="heuristic", because=self._unanswered)
        return rule

    def _ask_regions(self, now: Observation) -> RegionsAnswer:
        if not self.cfg.regions:
            return RegionsAnswer({})
        names = self._plan.names
        outcome = self.asker.ask(
            "contact-regions", RegionsAnswer, {**self._asked(), "stages": names},
            {"task": self._facts["instruction"], "objects": self._shown(), "stages": names},
            lambda answer: verify_regions(answer, self._facts, names, self.cfg.region), seen=True)
        found = outcome.answer or RegionsAnswer({})
        self._emit("regions", failure=outcome.failure, attempts=outcome.attempts,
                   refused=[rejection.reason for rejection in outcome.rejections],
                   regions=found.model_dump(mode="json"))
        return found

    def _strategy(self, name: str) -> Strategy:
        regions = self._regions if self.cfg.regions else None
        return make_strategy(name, self._plan, regions, self._world.schema, self._sizes, self._load, self._keep)

    def _keeping(self) -> LastGoodCost:
        def heard(cost: Cost, error: CostError) -> None:
            self._failure = self._failure or error
        return LastGoodCost(failed=heard)

    def _repaired(self) -> Strategy:
        try:
            strategy = self._strategy(f"repair {self._repairs}")
        except CostError as error:
            raise RunError(f"the repaired plan cannot be made: {error}") from None
        self._watch = Watch(self.cfg.outer, tuple(self._plan.names))
        return strategy

    def _replan(self, now: Observation, otherwise: Callable[[], PlanAnswer], error: str = "") -> None:
        steps, costs = self._watch.steps, self._watch.costs
        name = most_telling(steps) or next(iter(self._sizes))
        history = {"attempts": self._watch.attempts, "history": recent(steps, costs, name), "code": self._plan.text(),
                   "error": error}
        if self.cfg.unified:
            self._plan = self._ask_all(now, history) or otherwise()
            return
        plan = self._ask_plan("cost-repair", now, {
            "task": self._facts["instruction"], "world": self._shown(),
            "interface": interface_text(self._world.schema), **history})
        self._plan = plan or otherwise()
        self._regions = self._ask_regions(now)

    def _ask_all(self, now: Observation, history: Mapping[str, Any] | None = None) -> PlanAnswer | None:
        """One question about everything; what is accepted is believed, and so are its regions."""
        before = self._beliefs
        outcome = ask_all(self.asker, self._asked(), self._shown(), self._world,
                          lambda answer: self._wrong_plan(answer, now), self.cfg, history)
        found, self._unanswered = outcome.answer, outcome.failure
        if found is None:
            self._world.believe(before)
        else:
            self._regions = found.places
        self._facts = {**scene_facts(self._drawn, now, self._beliefs), "refused": len(outcome.rejections)}
        self._emit("beliefs", source=outcome.failure or "advisor", attempts=outcome.attempts, **_told(self._beliefs))
        self._tell_plan("unified", outcome)
        return None if found is None else found.plan

    def _refine(self, moment: Moment) -> Strategy | None:
        """The outer loop: what went wrong, a better world model, a better plan."""
        watch, now = self._watch, moment.now
        name = most_telling(watch.steps) or next(iter(self._sizes))
        kind = diagnose(watch.steps, name, watch.returns, watch.surprise_m.get(name, 0.0))
        self._repairs += 1
        self._emit("stuck", attempts=watch.attempts, stage=moment.stage, object=name, diagnosis=kind, text=TEXTS[kind],
                   cost=round(moment.plan.cost, 4), history=recent(watch.steps, watch.costs, name))
        corrected = not self.cfg.unified and self._correct(name, now)
        self._facts = {**scene_facts(self._drawn, now, self._beliefs), "refused": 0}
        if corrected and kind == "moved-otherwise":
            # The plan was right and the world model was not: the stage goes on, rehearsed in the corrected one.
            self._watch = Watch(self.cfg.outer, tuple(self._plan.names))
            return None
        self._diagnoses.append(kind)
        self._replan(now, lambda: self._plan)
        return self._repaired()

    def _correct(self, name: str, now: Observation) -> bool:
        past = Past(tuple(self._past), recent(self._watch.steps, self._watch.costs, name))
        return correct(self.asker, name, now, past, self._drawn, self._world, self._facts, self.cfg, self._rng,
                       self._emit)

    def _correct_in_passing(self, last: bool = False) -> None:
        """Correct by what was touched, stuck or not; plan and stage go on."""
        name = self._rhythm.due(self._past, last)
        if name is not None:
            self._correct(name, self._now)

    def _asked(self) -> dict[str, Any]:
        """The facts that go with a question about the plan."""
        return {**self._facts, "diagnoses": list(self._diagnoses), "contact_strategy": self.cfg.strategy}

    def _shown(self) -> dict[str, Any]:
        """The objects as prompts show them: nothing that only the default advisor needs."""
        hidden = ("stated_mass_kg", "stated_friction", "solid_share", "parts")
        return {name: {key: value for key, value in item.items() if key not in hidden}
                for name, item in self._facts["objects"].items()}

    def _plan_prompt(self) -> dict[str, Any]:
        objects = self._facts["objects"]
        return {"task": self._facts["instruction"],
                "poses": {name: item["pose"] for name, item in objects.items()} | {"hand": self._facts["hand"]["pose"]},
                "parameters": self._shown(), "interface": interface_text(self._world.schema)}

    def _experience(self) -> Experience:
        task = self._drawn.task
        return Experience(
            task=task.name, instruction=task.instruction, goals=self._facts["goals"],
            numbers=scene_numbers(self._facts),
            plan=self._plan, regions=self._regions,
            beliefs={name: (one.mass_kg, one.friction) for name, one in self._beliefs.items()},
            provenance={"success": True, "repairs": self._repairs, **self._provenance})


def _told(beliefs: Mapping[str, Physical]) -> dict[str, list[float]]:
    return {name: [round(one.mass_kg, 5), round(one.friction, 4)] for name, one in beliefs.items()}
