"""Adaptation of a remembered plan to the scene: names of objects, and regions scaled to their sizes."""

from __future__ import annotations

import re
from collections.abc import Mapping

from coral.contact.memory.memory import Experience
from coral.contact.memory.scene_numbers import roles
from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.contact.scene.facts import SceneFacts


def adapt(experience: Experience, facts: SceneFacts) -> tuple[PlanAnswer, RegionsAnswer]:
    """Rewrite a remembered plan and its regions for the names and sizes of this scene; verify them like new ones."""
    before = list(dict.fromkeys(goal["object"] for goal in experience.goals if goal["kind"] != "undisturbed"))
    names = dict(zip(before, roles(facts["goals"]), strict=False))
    plan = experience.plan
    programs = ("code", "done", "lost", "toward")
    stages = [
        StageAnswer.model_validate(
            {**stage.model_dump(), **{key: renamed(getattr(stage, key), names) for key in programs}}
        )
        for stage in plan.stages
    ]
    made = plan.model_copy(update={"code": renamed(plan.code, names), "stages": stages})
    regions: dict[str, ObjectRegions] = {}
    for name, held in experience.regions.root.items():
        if name not in names:
            continue
        role = before.index(name)
        old = [experience.numbers[f"object{role}.size.{k}"] for k in range(3)]
        new = facts["objects"][names[name]]["size_m"]
        regions[names[name]] = ObjectRegions(regions=[_stretch_region(region, old, new) for region in held.regions])
    return made, RegionsAnswer(regions)


def renamed(text: str, names: Mapping[str, str]) -> str:
    """Return the program with the quantities of some objects read from others."""

    def other(found: re.Match[str]) -> str:
        return f"self.{names[found[1]]}_"

    changed = {old: new for old, new in names.items() if old != new}
    if not changed:
        return text
    return re.sub(r"\bself\.(" + "|".join(map(re.escape, sorted(changed, key=len, reverse=True))) + ")_", other, text)


def _stretch_region(region: Region, old: list[float], new: list[float]) -> Region:
    x, y, z = (round(c * b / a, 5) for c, a, b in zip(region.center, old, new, strict=True))
    return region.model_copy(update={"center": (x, y, z)})
