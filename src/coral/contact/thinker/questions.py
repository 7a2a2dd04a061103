"""CoRAL's questions about a scene: physical parameters, plan, contact regions (A.6 to A.10).

One question for all of them is the ablation with a unified VLM (section 4, Table 1). The paper says only that it "uses
a single multimodal prompt for both perception and planning"; what follows from that is in
docs/reference/task-questions.md, "Ablations".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from pydantic import Field

from coral.advisor.consult import Outcome
from coral.advisor.question import Rejection
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.perception.scene_labels import PictureLabels
from coral.contact.plan.contact_regions import LIMITS, ObjectRegions, ReachBox, RegionsAnswer, reach_box
from coral.contact.plan.cost_plan import Compiled, Loader, PlanAnswer, make_strategy
from coral.contact.plan.imagined_run import stage_beginnings
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.sampled_states import sample_states
from coral.contact.plan.touchable_points import Scenery, candidates_of
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.observation import Array, Observation
from coral.contact.scene.trial import PhysicalParameters, Trial
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.diagnosis import Diagnosis
from coral.contact.thinker.repair_prompt import fit_prompt
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import world_prompt
from coral.contact.thinker.strategist import NoStrategy
from coral.contact.thinker.think_cfg import StandIn, ThinkCfg, stand_in
from coral.contact.world_model.parameter_estimates import (
    ParameterEstimate,
    ParameterEstimates,
    belief_prompt,
    verify_estimates,
)

Emit = Callable[..., None]


class Questions:
    """Asks about one scene and verifies the answers; without one, what is believed and followed already stands.

    `load` is for the cost programs of later answers; `facts` is the scene as last observed, `sizes` those of the
    objects (m), `scenery` their true shapes. Questions about the plan include the diagnoses so far. `stood_in` tells
    which current decisions are not the advisor's: parameters, plan, regions; `advice` what the last check of a plan
    noted without refusing it.
    """

    def __init__(
        self,
        asker: Asker,
        trial: Trial,
        world: PlanningWorld,
        cfg: ThinkCfg,
        load: Loader,
        emit: Emit,
        limits: Callable[[], PlannerLimits],
    ) -> None:
        self.facts: SceneFacts
        self.sizes = {name: trial.size(name) for name in trial.objects}
        self.scenery = Scenery.of(trial)
        self.diagnoses: list[Diagnosis] = []
        self.stood_in: set[str] = set()
        self._asker, self._trial, self._world, self._cfg = asker, trial, world, cfg
        self.load, self._emit, self._limits = load, emit, limits
        self._unanswered = ""
        self.advice: tuple[str, ...] = ()

    @property
    def _reach(self) -> ReachBox:
        return reach_box(self._limits().controller)

    @property
    def beliefs(self) -> dict[str, PhysicalParameters]:
        """Return the planning world's beliefs about the objects."""
        return dict(self._world.beliefs[0])

    def update_facts(self, now: Observation, believed: bool = True) -> None:
        """Update the scene's facts, with or without the beliefs about the objects."""
        self.facts = scene_facts(self._trial, now, self.beliefs if believed else None)
        self._seen = now

    def ask_parameters(self, given: Mapping[str, PhysicalParameters]) -> None:
        """Ask for masses and frictions and adopt them; given values take precedence."""
        if set(given) >= set(self.sizes):
            self._world.believe(given)
            self._emit("beliefs", source="given", failure="", attempts=0, refused=[], **_round_beliefs(given))
            return
        outcome = self._asker.ask(
            "physical-parameters",
            ParameterEstimates,
            self.facts,
            belief_prompt(self.facts),
            lambda answer: verify_estimates(answer, {name: list(size) for name, size in self.sizes.items()}),
            with_picture=True,
        )
        if outcome.answer is None:
            self._stand_in("parameters", outcome.failure, "the prior beliefs")
        beliefs = {**(self.beliefs if outcome.answer is None else outcome.answer.physical()), **given}
        self._world.believe(beliefs)
        self._emit("beliefs", **self._outcome_fields("parameters", outcome), **_round_beliefs(beliefs))

    def ask_plan(self, now: Observation, history: Mapping[str, Any] | None = None) -> PlanAnswer | None:
        """Ask for a plan, or for another one if the history of the last is given; None without an answer."""
        kind, shown = "cost-function", self.world_prompt()
        if history is not None:
            kind, shown = "cost-repair", fit_prompt("cost-repair", {**shown, **history})
        outcome = self._asker.ask(
            kind,
            PlanAnswer,
            self._plan_facts(),
            shown,
            lambda plan: self.check_plan(plan, self.present(now)),
            with_picture=self._cfg.prompt != "paper",  # A.8 to A.10 are text
            labels=PictureLabels.of(self._trial.task, now),
        )
        if self.present(now) is not now:  # the episode continued while the advisor answered
            self.update_facts(self.present(now))
        self.facts["refused"] = len(outcome.rejections)
        self._emit_plan(kind, outcome, "plan" if history is None else "repair")
        self._unanswered = outcome.failure
        return outcome.answer

    def no_plan(self) -> NoReturn:
        """End the episode, which has no plan to follow.

        Raises:
            NoStrategy: Always under `prior`.
            NoDecision: Always under another policy.
        """
        if self._cfg.fallback != "prior":
            self._stand_in("plan", self._unanswered, "")
        raise NoStrategy(f"the advisor gave no plan ({self._unanswered})")

    def keep_plan(self, plan: PlanAnswer) -> PlanAnswer:
        """Keep the plan because the advisor gives no repair.

        Raises:
            NoDecision: The policy forbids it.
        """
        self._stand_in("repair", self._unanswered, "the plan before")
        return plan

    def ask_regions(self, plan: PlanAnswer) -> RegionsAnswer:
        """Ask where the stages of a plan touch; no regions without an answer.

        Raises:
            NoDecision: The advisor does not answer and the policy lets nobody else answer.
        """
        if not self._cfg.regions:
            return RegionsAnswer({})
        asked: SceneFacts = {**self._plan_facts(), "stages": plan.names}
        outcome = self._asker.ask(
            "contact-regions",
            RegionsAnswer,
            asked,
            {**self.world_prompt(), "plan": plan.outline(), "limits": LIMITS},
            lambda answer: self.check_regions(answer, plan),
            with_picture=self._cfg.prompt != "paper",  # A.8 to A.10 are text
            labels=PictureLabels.of(self._trial.task, self._seen),
        )
        if outcome.answer is None:  # regions only guide samples: `fail` alone lets no failure pass
            self.stood_in.add("regions")
            policy: StandIn = "fail" if self._cfg.fallback == "fail" else "prior"
            stand_in(self._emit, policy, "regions", outcome.failure, "no regions")
        found = outcome.answer or RegionsAnswer({})
        self._emit("regions", **self._outcome_fields("regions", outcome), regions=found.model_dump(mode="json"))
        return found

    def check_regions(self, regions: RegionsAnswer, plan: PlanAnswer) -> Rejection | None:
        """Return why a plan's regions cannot be used in the scene as last observed; None if they can."""
        return verify_regions(regions, self.facts, plan.names, self.scenery, self._reach)

    def touchable_candidates(self, regions: RegionsAnswer, plan: PlanAnswer) -> list[Array]:
        """Return the points of each region that can be touched; report how many were dropped and why."""
        found = candidates_of(regions, self.facts, plan.names, self.scenery, self._reach)
        dropped = [
            {"object": name, "stage": region.stage, "kept": len(left.points), "lost": dict(left.lost)}
            for (name, region), left in zip(regions.each(), found, strict=True)
            if left.lost
        ]
        if dropped:
            self._emit("candidates", regions=dropped)
        return [left.points for left in found]

    def ask_everything(
        self, now: Observation, history: Mapping[str, Any] | None = None
    ) -> tuple[PlanAnswer, RegionsAnswer] | None:
        """Ask a single question about everything (variant `unified`) and adopt the accepted beliefs."""
        before, facts = self.beliefs, self._plan_facts()
        sizes = {name: item["size_m"] for name, item in facts["objects"].items()}

        def wrong(answer: UnifiedAnswer) -> Rejection | None:
            refusal = verify_estimates(answer.estimates, sizes)
            if refusal is not None:
                return refusal
            self._world.believe(answer.estimates.physical())  # the plan is checked under the beliefs that come with it
            refusal = self.check_plan(answer, self.present(now))
            if refusal is None and self._cfg.regions:
                refusal = self.check_regions(answer.places, answer)
            return refusal

        prompt = {**self.world_prompt(), "places": self._cfg.regions, "code": "", "error": ""}
        if history is not None:
            prompt = fit_prompt("unified", {**prompt, **history})
        outcome = self._asker.ask(
            "unified",
            UnifiedAnswer,
            facts,
            prompt,
            wrong,
            with_picture=True,
            labels=PictureLabels.of(self._trial.task, now),
        )
        found, self._unanswered = outcome.answer, outcome.failure
        if found is None:
            self._world.believe(before)
        self.update_facts(self.present(now))
        self.facts["refused"] = len(outcome.rejections)
        self._emit("beliefs", failure=outcome.failure, attempts=outcome.attempts, **_round_beliefs(self.beliefs))
        self._emit_plan("unified", outcome, "plan" if history is None else "repair")
        return None if found is None else (found.plan, found.places)

    def check_plan(self, plan: PlanAnswer, now: Observation, remembered: bool = False) -> Rejection | None:
        """Return why a plan's programs cannot be used on states around the present one; None if they can."""
        if self._cfg.prompt == "paper" and plan.stages and not remembered and self._asker.source == "advisor":
            return Rejection(code="stages", reason="give one function, `code`, and no stages")

        def beginnings(compiled: Sequence[Compiled]) -> dict[str, Context]:
            followed = make_strategy("imagined", plan, None, self._world.schema, self.sizes, self.load)
            names = [made.answer.name for made in compiled]
            found = stage_beginnings(self._world, followed, now, names)
            return {name: sample_states(self._world, start, self.sizes) for name, start in found.items()}

        verdict = judge_plan(
            plan, self._world.schema, sample_states(self._world, now, self.sizes), self.load, beginnings=beginnings
        )
        self.advice = verdict.advice
        return verdict.refusal

    def present(self, before: Observation) -> Observation:
        """Return the latest observation: a new one if the episode continued while an advisor answered."""
        thinking = self._asker.clock.thinking
        return before if thinking is None else thinking.now

    def _stand_in(self, what: str, failure: str, by: str) -> None:
        if what != "repair":  # the plan before is the advisor's own
            self.stood_in.add(what)
        stand_in(self._emit, self._cfg.fallback, what, failure, by)

    def _outcome_fields(self, what: str, outcome: Outcome[Any]) -> dict[str, Any]:
        """Return the attempts of a decision and who decided, for its event."""
        refused = [rejection.reason for rejection in outcome.rejections]
        told = {"failure": outcome.failure, "attempts": outcome.attempts, "refused": refused}
        if outcome.answer is None:
            return told
        self.stood_in.discard(what)
        return {**told, "decided": what, "source": self._asker.source}

    def _emit_plan(self, kind: str, outcome: Outcome[Any], what: str) -> None:
        plan: PlanAnswer | None = outcome.answer
        if plan is not None:
            self.stood_in.discard("plan")
        self._emit(
            "plan_answer",
            kind=kind,
            **self._outcome_fields(what, outcome),
            explanation="" if plan is None else plan.explanation,
            code="" if plan is None else plan.text(),
            advice=[] if plan is None else list(self.advice),
        )

    def _plan_facts(self) -> SceneFacts:
        """Return the facts of a question about the plan."""
        facts = self.facts if self._cfg.prompt == "full" else {**self.facts, "goals": []}
        return {**facts, "diagnoses": list(self.diagnoses), "contact_strategy": self._cfg.strategy}

    def world_prompt(self) -> dict[str, Any]:
        """Return what every question about a plan shows of task, scene, hand, planner and cost language."""
        return world_prompt(self.facts, self._trial.task, self._world.schema, self._cfg, self._limits())


def _round_beliefs(beliefs: Mapping[str, PhysicalParameters]) -> dict[str, list[float]]:
    return {name: [round(one.mass_kg, 5), round(one.friction, 4)] for name, one in beliefs.items()}


class UnifiedAnswer(PlanAnswer):
    """A plan together with what it is a plan for.

    Args:
        parameters: Mass and friction by the objects' names.
        regions: Where to touch, by the objects' names.
    """

    parameters: dict[str, ParameterEstimate]
    regions: dict[str, ObjectRegions] = Field(default_factory=dict)

    @property
    def estimates(self) -> ParameterEstimates:
        """Return the estimates in the form of their own question."""
        return ParameterEstimates(self.parameters)

    @property
    def places(self) -> RegionsAnswer:
        """Return the regions in the form of their own question."""
        return RegionsAnswer(self.regions)

    @property
    def plan(self) -> PlanAnswer:
        """Return the plan in the form of its own question."""
        return PlanAnswer(code=self.code, stages=self.stages, begin=self.begin, explanation=self.explanation)
