"""Composition of the default advisor's plan: programs and regions from the task file's goals.

No rule knows a task by its name. The goals of an object and its size decide between grasping from above, pushing,
tipping, raising against an upright face, and pinching beyond the table's edge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.contact.rules.goals import (
    NoRule,
    goal_words,
    movement_goals,
    placing_goal,
    require_different_kinds,
    require_only,
)
from coral.contact.rules.placement import placement_of
from coral.contact.rules.scene_reading import Draft, SkillAdjustment, Thing, number
from coral.contact.rules.skill_edge import add_overhang, can_overhang
from coral.contact.rules.skill_grasp import add_grasp, add_lift, add_place, add_release
from coral.contact.rules.skill_pivot import add_pivot
from coral.contact.rules.skill_push import add_push, add_tip
from coral.contact.scene.facts import AtGoal, Goal, GoalsByKind, SceneFacts, goals_by_kind


@dataclass(frozen=True)
class Composed:
    """A plan with its regions."""

    plan: PlanAnswer
    regions: RegionsAnswer


def compose(facts: SceneFacts, adjustment: SkillAdjustment | None = None) -> Composed:
    """Compose the plan for a scene.

    Args:
        facts: Facts of the scene (`scene_facts`), with its goals.
        adjustment: Changes made by repairs.

    Raises:
        NoRule: No rule reaches the goals; the text names them.
    """
    adjustment = adjustment or SkillAdjustment()
    drafts = []
    for name in dict.fromkeys(goal["object"] for goal in facts["goals"]):
        asked = [goal for goal in facts["goals"] if goal["object"] == name]
        moving = movement_goals(asked, facts)
        if not moving:
            continue
        require_different_kinds(moving)
        thing = Thing(name, facts)
        drafts.append((thing, _for_object(thing, goals_by_kind([*asked, *moving]), moving, facts, adjustment)))
    if not drafts:
        asked_for = ", ".join(goal_words(goal) for goal in facts["goals"])
        raise NoRule(f"no goal asks for anything to be moved: {asked_for}")
    merged = Draft()
    for before, (_, draft) in zip([None, *(thing for thing, _ in drafts)], drafts, strict=False):
        _append(merged, draft, before)
    held: dict[str, list[Region]] = {}
    for name, region in merged.regions:
        held.setdefault(name, []).append(region)
    words = "; ".join(merged.words)
    return Composed(
        PlanAnswer(stages=merged.stages, explanation=f"{words[:1].upper()}{words[1:]}."),
        RegionsAnswer({name: ObjectRegions(regions=regions) for name, regions in held.items()}),
    )


def _for_object(
    thing: Thing, goals: GoalsByKind, moving: Sequence[Goal], facts: SceneFacts, adjustment: SkillAdjustment
) -> Draft:
    """Choose the one skill that reaches all goals of an object.

    Args:
        thing: The object.
        goals: Its goals by kind.
        moving: The goals that require it to be moved.
        facts: Facts of the scene.
        adjustment: Changes made by repairs.

    Raises:
        NoRule: No skill reaches all of them.
    """
    draft, asked = Draft(), {goal["kind"] for goal in moving}
    if "flipped" in asked:
        against = goals.get("touched-while-turning", {}).get("thing")
        require_only({"flipped", "touched-while-turning"}, moving, thing.name, "turned over")
        if not 45 < goals["flipped"]["degrees"] < 135:
            raise NoRule(f"no rule turns the {thing.name} by other than a right angle: {goal_words(goals['flipped'])}")
        if against in facts["objects"]:
            raise NoRule(
                f"no rule turns the {thing.name} against what moves itself: "
                f"{goal_words(goals['touched-while-turning'])}"
            )
        if against in facts["fixtures"]:
            add_pivot(draft, thing, facts, against, adjustment)
        else:
            add_tip(draft, thing, facts, adjustment)
        return draft
    to_place = goals.get("at")
    if "steady-force" in asked or ("at" in asked and not thing.closings()):
        require_only({"steady-force", "at"}, moving, thing.name, "pushed")
        place = to_place or _default_place(thing, facts)
        add_push(draft, thing, facts, place, goals.get("steady-force", {}).get("newtons"), adjustment)
        return draft
    held = {"lifted", "grasped"} & asked
    if held and thing.closings():
        require_only({"lifted", "grasped"}, moving, thing.name, "held")
        add_grasp(draft, thing, facts, adjustment)
        lift = max(goals.get("lifted", {}).get("height_m", 0.0), 0.02)
        add_lift(draft, thing, facts, lift, adjustment)
        if "released" in goals:
            add_release(draft, thing, facts, adjustment)
        return draft
    if held and can_overhang(thing):
        require_only({"lifted", "grasped"}, moving, thing.name, "held")
        lift = max(goals.get("lifted", {}).get("height_m", 0.0), 0.02)
        add_overhang(draft, thing, facts, lift, adjustment)
        return draft
    put = placing_goal(goals, moving)
    if put is not None and thing.closings():
        # A placed object also rests; the placement decides on which surface.
        require_only({put["kind"], "resting"}, moving, thing.name, "put down")
        placement = placement_of(thing, facts, put)
        add_grasp(draft, thing, facts, adjustment)
        add_place(draft, thing, facts, placement, adjustment)
        return draft
    unserved = ", ".join(map(goal_words, moving))
    raise NoRule(
        f"the {thing.name} is too wide to grasp and no goal can be reached by pushing: {unserved}"
        if not thing.closings()
        else f"no rule moves the {thing.name} so: {unserved}"
    )


def _default_place(thing: Thing, facts: SceneFacts) -> AtGoal:
    """Return the place to push to if only a force is asked for: the first place of the task.

    Raises:
        NoRule: The task has no place.
    """
    if not facts["places"]:
        raise NoRule(f"a force is asked for on the {thing.name}, but no place to push it to")
    place = next(iter(facts["places"]))
    return {"object": thing.name, "kind": "at", "place": place, "point": None, "tolerance_m": 0.02, "axes": "xy"}


def _append(merged: Draft, draft: Draft, before: Thing | None) -> None:
    """Append an object's stages with unique names; the stage before them ends once the hand is clear of its object."""
    taken = {stage.name for stage in merged.stages}
    names = {
        stage.name: stage.name if stage.name not in taken else _free_name(stage.name, taken) for stage in draft.stages
    }
    if before is not None and not merged.stages[-1].done:
        n, clear = before.name, number(before.height / 2 + 0.06)
        done = f"not self.{n}_hand_contact and norm(self.ee_pos - self.{n}_pos) > {clear}"
        merged.stages[-1] = merged.stages[-1].model_copy(update={"done": done})
    for stage in draft.stages:
        merged.stages.append(_rename_stage(stage, names))
    merged.regions += [
        (name, region.model_copy(update={"stage": names.get(region.stage, region.stage)}))
        for name, region in draft.regions
    ]
    merged.words += draft.words


def _free_name(name: str, taken: set[str]) -> str:
    return next(f"{name} {k}" for k in range(2, 100) if f"{name} {k}" not in taken)


def _rename_stage(stage: StageAnswer, names: Mapping[str, str]) -> StageAnswer:
    return stage.model_copy(update={"name": names[stage.name], "back_to": names.get(stage.back_to, stage.back_to)})
