"""Perception and planning in one question: the ablation with a unified VLM (section 4, Table 1).

The paper says only that it "uses a single multimodal prompt for both perception and planning". The consequences drawn
here are listed in docs/reference/task-questions.md, "Ablations".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import Field

from coral.advisor.consult import Outcome
from coral.advisor.question import Rejection
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.perception.scene_labels import PictureLabels
from coral.contact.plan.contact_regions import ObjectRegions, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery
from coral.contact.scene.facts import SceneFacts
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.repair_prompt import fit_prompt
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.world_model.parameter_estimates import ParameterEstimate, ParameterEstimates, verify_estimates

KIND = "unified"


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


def unified_prompt(shown: Mapping[str, Any], cfg: ThinkCfg, history: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the placeholders of the single question; the arguments are those of `ask_unified`."""
    prompt: dict[str, Any] = {**shown, "places": cfg.regions, "code": "", "error": ""}
    return prompt if history is None else fit_prompt(KIND, {**prompt, **history})


def ask_unified(
    asker: Asker,
    facts: SceneFacts,
    shown: Mapping[str, Any],
    world: PlanningWorld,
    wrong_plan: Callable[[UnifiedAnswer], Rejection | None],
    cfg: ThinkCfg,
    scenery: Scenery,
    labels: PictureLabels | None = None,
    history: Mapping[str, Any] | None = None,
) -> Outcome[UnifiedAnswer]:
    """Ask the single question. While an answer is checked, the planning world adopts its beliefs.

    Args:
        asker: The advisor.
        facts: Facts of the scene.
        shown: Task, scene, hand, planner and cost language as prompts show them.
        world: The planning world.
        wrong_plan: Returns why the plan's programs cannot be used, or None.
        cfg: Thresholds.
        scenery: True shapes of the objects.
        labels: What to write into the picture.
        history: For a repair: what the prompt says of the plan that failed.
    """
    prompt = unified_prompt(shown, cfg, history)
    sizes = {name: item["size_m"] for name, item in facts["objects"].items()}

    def wrong(answer: UnifiedAnswer) -> Rejection | None:
        refusal = verify_estimates(answer.estimates, sizes, cfg.belief)
        if refusal is not None:
            return refusal
        world.believe(answer.estimates.physical())
        refusal = wrong_plan(answer)
        if refusal is None and cfg.regions:
            refusal = verify_regions(answer.places, facts, answer.names, cfg.region, scenery)
        return refusal

    return asker.ask(KIND, UnifiedAnswer, facts, prompt, wrong, with_picture=True, labels=labels)
