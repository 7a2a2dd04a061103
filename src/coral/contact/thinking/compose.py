"""The default advisor's plan: program texts and regions composed from the task file's goals by general rules.

No rule knows a task by its name. What a goal asks of an object, and what its size allows the hand to do, choose among
grasping from above, pushing, tipping, raising against something upright, and pinching beyond the table's edge.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coral.contact.thinking.plan_answer import PlanAnswer, StageAnswer
from coral.contact.thinking.regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.thinking.setting import Choice, Draft, Thing
from coral.contact.thinking.skill_edge import add_overhang, can_overhang
from coral.contact.thinking.skill_grasp import add_grasp, add_lift, add_place, add_release
from coral.contact.thinking.skill_pivot import add_pivot
from coral.contact.thinking.skill_push import add_push, add_tip


@dataclass(frozen=True)
class Composed:
    """A plan with the regions that belong to it."""

    plan: PlanAnswer
    regions: RegionsAnswer


class NoRule(ValueError):
    """The rules know no way to what is asked."""


def compose(facts: Mapping[str, Any], choice: Choice | None = None) -> Composed:
    """The plan for a scene.

    Args:
        facts: The scene (`scene_facts`) with its goals.
        choice: What repairs have changed.

    Raises:
        NoRule: The rules know no way; the text says to what.
    """
    choice = choice or Choice()
    drafts = []
    for name in dict.fromkeys(goal["object"] for goal in facts["goals"]):
        goals = {goal["kind"]: goal for goal in facts["goals"] if goal["object"] == name}
        if set(goals) <= {"undisturbed", "upright", "released"}:
            continue
        drafts.append(_for_object(Thing(name, facts), goals, facts, choice))
    if not drafts:
        raise NoRule("no goal asks for anything to be moved")
    merged = Draft()
    for draft in drafts:
        _append(merged, draft)
    held: dict[str, list[Region]] = {}
    for name, region in merged.regions:
        held.setdefault(name, []).append(region)
    words = "; ".join(merged.words)
    return Composed(PlanAnswer(stages=merged.stages, explanation=f"{words[:1].upper()}{words[1:]}."),
                    RegionsAnswer({name: ObjectRegions(regions=regions) for name, regions in held.items()}))


def _for_object(thing: Thing, goals: Mapping[str, Any], facts: Mapping[str, Any], choice: Choice) -> Draft:
    draft = Draft()
    turned = "flipped" in goals and goals["flipped"]["degrees"] > 45
    if turned:
        against = goals.get("touched-while-turning", {}).get("thing")
        if against in facts["fixtures"]:
            add_pivot(draft, thing, facts, against, choice)
        else:
            add_tip(draft, thing, facts, choice)
        return draft
    to_place = goals.get("at")
    pushed = "steady-force" in goals or bool(to_place and not thing.closings())
    if pushed:
        place = to_place or _straight_on(thing, facts)
        add_push(draft, thing, facts, place, goals.get("steady-force", {}).get("newtons"), choice)
        return draft
    lift = max(goals.get("lifted", {}).get("height_m", 0.0), 0.0 if to_place else 0.02)
    if thing.closings():
        add_grasp(draft, thing, facts, choice)
        if to_place:
            add_place(draft, thing, facts, to_place, choice)
        elif "lifted" in goals or "grasped" in goals:
            add_lift(draft, thing, facts, lift, choice)
            if "released" in goals:
                add_release(draft, thing, facts, choice)
        return draft
    if ("lifted" in goals or "grasped" in goals) and can_overhang(thing):
        add_overhang(draft, thing, facts, lift, choice)
        return draft
    raise NoRule(f"the {thing.name} is too wide to grasp and no goal can be reached by pushing: {', '.join(goals)}")


def _straight_on(thing: Thing, facts: Mapping[str, Any]) -> dict[str, Any]:
    """Where to push to when only a force is asked for: the first place of the task.

    Raises:
        NoRule: There is none.
    """
    if not facts["places"]:
        raise NoRule(f"a force is asked for on the {thing.name}, but no place to push it to")
    return {"place": next(iter(facts["places"])), "tolerance_m": 0.02, "axes": "xy"}


def _append(merged: Draft, draft: Draft) -> None:
    """Add one object's stages after another's, its names made its own, the one before ending when it has settled."""
    taken = {stage.name for stage in merged.stages}
    names = {stage.name: stage.name if stage.name not in taken else _free(stage.name, taken) for stage in draft.stages}
    if merged.stages and not merged.stages[-1].done:
        merged.stages[-1] = merged.stages[-1].model_copy(update={"done": "norm(self.ee_vel) < 0.05"})
    for stage in draft.stages:
        merged.stages.append(_renamed(stage, names))
    merged.regions += [(name, region.model_copy(update={"stage": names.get(region.stage, region.stage)}))
                       for name, region in draft.regions]
    merged.words += draft.words


def _free(name: str, taken: set[str]) -> str:
    return next(f"{name} {k}" for k in range(2, 100) if f"{name} {k}" not in taken)


def _renamed(stage: StageAnswer, names: Mapping[str, str]) -> StageAnswer:
    return stage.model_copy(update={"name": names[stage.name], "back_to": names.get(stage.back_to, stage.back_to)})
