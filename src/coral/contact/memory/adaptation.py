"""Adaptation of a remembered plan to the scene: names of things, and regions. Its numbers stay as they are."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence

from coral.contact.memory.goal_match import GoalMatch, roles
from coral.contact.memory.memory import Experience, RememberedPlan
from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.contact.scene.facts import SceneFacts

PROGRAMS = ("code", "done", "toward")
"""Fields of a stage that hold programs, beside the conditions of `next`."""


def adapt(experience: Experience, facts: SceneFacts, goals: GoalMatch) -> tuple[RememberedPlan, ...]:
    """Rewrite a remembered plan, its repairs, and their regions for this scene; verify them like new ones.

    Names follow the goals. Regions are stretched with their objects. Cost terms about things that are not here, such as
    a term that leaves a neighbour alone, are dropped.
    """
    names, absent = _counterparts(experience, facts, goals)

    def rewrite(program: str) -> str:
        return renamed(_without_terms_of(program, absent), names)

    def rewrite_plan(plan: PlanAnswer) -> PlanAnswer:
        stages = [
            StageAnswer.model_validate(
                {
                    **stage.model_dump(),
                    **{key: rewrite(getattr(stage, key)) for key in PROGRAMS},
                    "next": {to: rewrite(test) for to, test in stage.next.items()},
                }
            )
            for stage in plan.stages
        ]
        return plan.model_copy(update={"code": rewrite(plan.code), "stages": stages})

    def stretch(remembered: RegionsAnswer) -> RegionsAnswer:
        regions: dict[str, ObjectRegions] = {}
        for name, held in remembered.root.items():
            if names.get(name) not in facts["objects"]:
                continue
            key = f"object{roles(experience.goals).index(name)}.size" if name in roles(experience.goals) else ""
            old = [experience.numbers.get(f"{key}.{k}", 0.0) for k in range(3)]
            new = facts["objects"][names[name]]["size_m"]
            stretched = [_stretch_region(region, old, new) if all(old) else region for region in held.regions]
            regions[names[name]] = ObjectRegions(regions=stretched)
        return RegionsAnswer(regions)

    steps = (RememberedPlan(plan=experience.plan, regions=experience.regions), *experience.then)
    return tuple(RememberedPlan(plan=rewrite_plan(step.plan), regions=stretch(step.regions)) for step in steps)


def _counterparts(experience: Experience, facts: SceneFacts, goals: GoalMatch) -> tuple[dict[str, str], list[str]]:
    """Return the names of things here by their remembered names, and what has no counterpart here."""
    names, absent = dict(goals.names), []
    for name in experience.beliefs:
        if name in names:
            continue
        free = [other for other in facts["objects"] if other not in names.values()]
        if not free:
            absent.append(name)
            continue
        names[name] = name if name in free else free[0]
    return names, absent


def renamed(text: str, names: Mapping[str, str]) -> str:
    """Return the program with the quantities of some things read from others."""
    changed = {old: new for old, new in names.items() if old != new}
    if not changed:
        return text
    one_of = "|".join(map(re.escape, sorted(changed, key=len, reverse=True)))
    # The first name owns the quantity, a second one is what it touches or nears: self.box_wall_contact.
    text = re.sub(
        rf"(\bself\.\w+_)({one_of})(?=_(?:contact|clearance)\b)", lambda found: found[1] + changed[found[2]], text
    )
    return re.sub(rf"\bself\.({one_of})_", lambda found: f"self.{changed[found[1]]}_", text)


def _without_terms_of(program: str, absent: Sequence[str]) -> str:
    """Return a program without the terms that read a quantity of an absent thing, directly or through a variable."""
    if not absent:
        return program
    one_of = "|".join(map(re.escape, absent))
    reads = re.compile(rf"({one_of})_|\w+_({one_of})_(contact|clearance)$")
    try:
        tree = ast.parse(program)
        # Nothing is written anew that reads only what is here.
        if not any(isinstance(node, ast.Attribute) and reads.match(node.attr) for node in ast.walk(tree)):
            return program
        return ast.unparse(_WithoutTerms(reads).visit(tree))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return program


class _WithoutTerms(ast.NodeTransformer):
    """Drops assignments and entries that read an absent thing; what else reads it remains, and is refused."""

    def __init__(self, reads: re.Pattern[str]) -> None:
        self._reads = reads
        self._dropped: set[str] = set()

    def visit_Assign(self, node: ast.Assign) -> ast.AST | None:
        """Drop an assignment, and with it what reads its variables."""
        node.value = self.visit(node.value)
        if not self._is_absent(node.value):
            return node
        self._dropped |= {target.id for target in node.targets if isinstance(target, ast.Name)}
        return None

    def visit_Dict(self, node: ast.Dict) -> ast.AST:
        """Drop the terms of a cost."""
        kept = [(key, value) for key, value in zip(node.keys, node.values, strict=True) if not self._is_absent(value)]
        node.keys, node.values = [key for key, _ in kept], [value for _, value in kept]
        return node

    def _is_absent(self, value: ast.expr) -> bool:
        return any(
            (isinstance(node, ast.Attribute) and self._reads.match(node.attr) is not None)
            or (isinstance(node, ast.Name) and node.id in self._dropped)
            for node in ast.walk(value)
        )


def _stretch_region(region: Region, old: Sequence[float], new: Sequence[float]) -> Region:
    x, y, z = (round(c * b / a, 5) for c, a, b in zip(region.center, old, new, strict=True))
    return region.model_copy(update={"center": (x, y, z)})
