"""Perception and planning in one question: the ablation with a unified VLM (section 4, Table 1).

The paper says that it "uses a single multimodal prompt for both perception and planning", and no more. What follows
from that here is decided in one place, docs/contact-mind.md, "Ablations".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import Field

from coral.advisor.consult import Outcome
from coral.advisor.question import Rejection
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.plan.contact_regions import ObjectRegions, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.question_facts import PlanFacts
from coral.contact.thinker.scene_facts import interface_text
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
        """Return the estimates as their own question would give them."""
        return ParameterEstimates(self.parameters)

    @property
    def places(self) -> RegionsAnswer:
        """Return the regions as their own question would give them."""
        return RegionsAnswer(self.regions)

    @property
    def plan(self) -> PlanAnswer:
        """Return the plan as its own question would give it."""
        return PlanAnswer(code=self.code, stages=self.stages, explanation=self.explanation)


def ask_unified(
    asker: Asker,
    facts: PlanFacts,
    shown: Mapping[str, Any],
    world: PlanningWorld,
    wrong_plan: Callable[[UnifiedAnswer], Rejection | None],
    cfg: ThinkCfg,
    scenery: Scenery,
    history: Mapping[str, Any] | None = None,
) -> Outcome[UnifiedAnswer]:
    """Ask the one question. While an answer is checked, the planning world adopts its beliefs.

    Args:
        asker: The advisor.
        facts: The scene.
        shown: The objects as prompts show them.
        world: The planning world.
        wrong_plan: Why its programs cannot be used.
        cfg: Thresholds.
        scenery: True shapes of the objects.
        history: In a repair: attempts, history, code and error.
    """
    objects = {name: {"mass_kg": None, "friction": None, **item} for name, item in shown.items()}
    prompt = {
        "task": facts["instruction"],
        "objects": objects,
        "hand": facts["hand"],
        "interface": interface_text(world.schema),
        "places": cfg.regions,
        "code": "",
        "error": "",
        **(history or {}),
    }
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

    return asker.ask(KIND, UnifiedAnswer, facts, prompt, wrong, with_picture=True)
