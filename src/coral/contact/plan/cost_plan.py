"""A plan as an advisor gives it: cost programs as text, stage by stage, compiled to a strategy.

Costs, conditions and guides that read an object which was never seen wait for it.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import BaseModel, Field, model_validator

from coral.contact.cost.context import Context, Cost, ReadingCost, Schema, Terms
from coral.contact.cost.schema import objects_of
from coral.contact.cost.stages import Guide, Stage, Strategy, Test
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.plan.contact_regions import RegionsAnswer, guide
from coral.contact.plan.plan_language import MOST_NAMES, MOST_STAGES, write_out
from coral.contact.scene.observation import Array

Loader = Callable[[str, Schema, str], Cost]
"""Makes a cost from source, schema and name: in this process, or in the confined one."""
KNOWN = ("_seen", "_size", "_mass", "_friction")
"""Ends of the quantities of an object that are known or believed before it is seen."""


def with_loops(schema: dict[str, Any]) -> None:
    """Let the schema of a list of stages allow loops, which are gone once the answer is read."""
    turns = {"type": "array", "items": {"type": "object", "additionalProperties": {"type": "string"}}}
    stage = schema["items"]
    inner = {"type": "array", "items": stage}
    loop = {"type": "object", "properties": {"for": turns, "stages": inner}, "required": ["for", "stages"]}
    schema["items"] = {"anyOf": [stage, loop]}


class StageAnswer(BaseModel):
    """One phase.

    Args:
        name: For logs, and for `next`.
        code: `def state_cost(self)`.
        done: Condition on the state now on which the next stage begins, as `self.box_pos[2] > 0.1`; "" for never.
        next: Ways to other stages, which begin anew, by name, with the condition for each; tested in order before
            `done`. `back_to` with `lost`, the stage and the condition of one such way, means the same.
        toward: Where some samples lead the tool, as `self.ee_pos + np.array([0.0, 0.0, 0.1])`; "" for nowhere.
        opening: Distance between the fingers on that way, m.
        stiffness: Of the hand, N/m.
        noise: Factor on the sampling noise.
    """

    name: str = Field(min_length=1, max_length=40)
    code: str
    done: str = ""
    next: dict[str, str] = Field(default_factory=dict, max_length=8)
    toward: str = ""
    opening: float | None = None
    stiffness: float = 600.0
    noise: float = 1.0

    @model_validator(mode="before")
    @classmethod
    def _one_way(cls, given: Any) -> Any:
        if not isinstance(given, dict) or not {"back_to", "lost"} & set(given):
            return given
        rest = {key: value for key, value in given.items() if key not in ("back_to", "lost")}
        to, lost = given.get("back_to") or "", given.get("lost") or ""
        if bool(to) != bool(lost):
            raise ValueError("`back_to` and `lost` go together")
        return {**rest, "next": {to: lost, **(given.get("next") or {})}} if to else rest

    def settings(self) -> list[tuple[str, str]]:
        """Return the names and values of what its author set besides programs and conditions."""
        plain = {key: field.default for key, field in type(self).model_fields.items()}
        values = {key: getattr(self, key) for key in ("toward", "opening", "stiffness", "noise")}
        return [(key, f"{value}") for key, value in values.items() if value != plain[key]]


class PlanAnswer(BaseModel):
    """The whole plan: `code` for one cost (the paper's A.8), or `stages`.

    Args:
        code: `def state_cost(self)` of a plan without stages.
        let: Names for expressions, written `{name}` in the texts of its stages; empty once they are written out.
        stages: In order. In what is given, an entry may also be a loop; see `plan_language`.
        begin: The stage with which a repair continues; "" for the first.
        explanation: What it does, and in a repair why the one before failed.
    """

    code: str = ""
    let: dict[str, str] = Field(default_factory=dict, max_length=MOST_NAMES)
    stages: list[StageAnswer] = Field(default_factory=list, max_length=MOST_STAGES, json_schema_extra=with_loops)
    begin: str = ""
    explanation: str = ""

    @model_validator(mode="before")
    @classmethod
    def _no_stage(cls, given: Any) -> Any:
        # A truncated reply may parse as its first stage alone, which would pass for a plan of one function.
        if isinstance(given, dict) and "name" in given and "stages" not in given:
            raise ValueError("this is one stage; give the whole plan, with its stages in the list `stages`")
        return write_out(given) if isinstance(given, dict) else given

    @model_validator(mode="after")
    def _one_of_both(self) -> PlanAnswer:
        if bool(self.code.strip()) == bool(self.stages):
            raise ValueError("give either `code`, one function, or `stages`, a list; not both and not neither")
        return self

    def each(self) -> list[StageAnswer]:
        """Return the stages; a single function is one stage."""
        return self.stages or [StageAnswer(name="task", code=self.code)]

    @property
    def names(self) -> list[str]:
        """Return the names of the stages."""
        return [stage.name for stage in self.each()]

    def text(self, numbered: bool = False) -> str:
        """Return all programs as text."""

        def shown(code: str) -> str:
            lines = code.strip().split("\n")
            return "\n".join(f"{k:2d}  {line}" for k, line in enumerate(lines, 1)) if numbered else code.strip()

        if not self.stages:
            return shown(self.code) if numbered else self.code
        parts = []
        for stage in self.stages:
            ways = [(f"next {to!r} when", test) for to, test in stage.next.items()]
            head = [f"# stage {stage.name!r}"] + [
                f"#   {key}: {value}"
                for key, value in (("done", stage.done), *ways, *(stage.settings() if numbered else ()))
                if value
            ]
            parts.append("\n".join([*head, shown(stage.code)]))
        return "\n\n".join(parts)

    def outline(self) -> str:
        """Return what the plan does without its costs: its explanation, and how each stage ends."""
        lines = [self.explanation] if self.explanation else []
        for stage in self.each():
            lines.append(f"- {stage.name}" + (f", until {flat(stage.done)}" if stage.done else ""))
        return "\n".join(lines)


def in_process(source: str, schema: Schema, name: str) -> Cost:
    """Make a cost that the closed interpreter evaluates in this process."""
    return CostProgram(source, schema, name)


def condition(text: str) -> str:
    """Make the program that is 1 while a condition holds."""
    return f"def state_cost(self):\n    return 1.0 * ({flat(text)})"


def vector(text: str) -> str:
    """Make the program whose terms are the components of a vector."""
    return f"def state_cost(self):\n    v = {flat(text)}\n    return {{'x': v[0], 'y': v[1], 'z': v[2]}}"


def flat(text: str) -> str:
    """Return an expression on one line, without comments."""
    return " ".join(re.sub(r"#[^\n]*", "", textwrap.dedent(text)).split())


@dataclass(frozen=True)
class Compiled:
    """The compiled programs of a stage."""

    answer: StageAnswer
    cost: Cost
    done: Cost | None
    next: Mapping[str, Cost]
    toward: Cost | None


def compile_stage(stage: StageAnswer, schema: Schema, load: Loader = in_process) -> Compiled:
    """Compile the programs of a stage.

    Raises:
        CostError: A program is not of the accepted language; the text names the field, unless it is `code`.
    """
    made: dict[str, Cost | None] = {}
    for field, source in (
        ("code", stage.code),
        ("done", stage.done and condition(stage.done)),
        *((f"next.{to}", condition(test)) for to, test in stage.next.items()),
        ("toward", stage.toward and vector(stage.toward)),
    ):
        try:
            made[field] = load(source, schema, stage.name) if source else None
        except CostError as error:
            if field == "code":
                raise
            # Its author wrote an expression, not the lines of the program made of it.
            raise CostError(error.code, f"`{field}`: {error.text}") from None
    cost = made["code"]
    if cost is None:
        raise CostError("empty", f"stage {stage.name!r} has no code")
    ways = {to: way for to in stage.next if (way := made[f"next.{to}"]) is not None}
    return Compiled(stage, cost, made["done"], ways, made["toward"])


def make_strategy(
    name: str,
    answer: PlanAnswer,
    regions: RegionsAnswer | None,
    schema: Schema,
    sizes: Mapping[str, Array],
    load: Loader = in_process,
    candidates: Sequence[Array] = (),
) -> Strategy:
    """Make the strategy that the planner follows, from a verified plan.

    Without verified regions the sampling is unguided (`unguided`, `no-regions`). `sizes` are full extents of the
    objects (m); `candidates` the touchable points of each region, in order, Shape=(n, 3) m in the object's frame.

    Raises:
        CostError: A program is not of the accepted language.
    """
    stages = []
    for said in answer.each():
        stage = compile_stage(said, schema, load)
        guides: list[Guide] = []
        if regions is not None:
            guides = [
                guide(thing, region, np.asarray(sizes[thing]), points)
                for (thing, region), points in zip(regions.each(), candidates, strict=True)
                if region.stage in ("", said.name) and len(points)
            ]
            if stage.toward is not None:
                guides.append(Guide(_points(stage.toward, schema), opening_m=said.opening))
        cost = waiting_cost(stage.cost, objects_read(stage.cost, schema))
        stages.append(
            Stage(
                said.name,
                cost,
                tuple(guides),
                said.stiffness,
                None if stage.done is None else _test(stage.done, schema),
                tuple((to, _test(way, schema)) for to, way in stage.next.items()),
                said.noise,
                keeps_off=not presses_by_design(stage.cost, schema),
            )
        )
    return Strategy(name, tuple(stages), answer.begin)


def presses_by_design(cost: Cost, schema: Schema) -> bool:
    """Check whether a cost says itself what the hand is to do to table or fixtures.

    The planner keeps the hand from pressing on them otherwise.
    """
    fixed = {name.removesuffix("_hand_contact") for name in schema if name.endswith("_hand_contact")}
    fixed -= set(objects_of(schema))
    kinds = ("hand_force", "hand_contact", "palm_contact")
    return isinstance(cost, ReadingCost) and any(f"{name}_{kind}" in cost.reads for name in fixed for kind in kinds)


def _test(program: Cost, schema: Schema) -> Test:
    objects = objects_read(program, schema)

    def holds(now: Context) -> bool:
        if unseen_of(now, objects):
            return False
        return sum(float(np.asarray(term).flat[0]) for term in program(now).values()) > 0.5

    return holds


def _points(program: Cost, schema: Schema) -> Callable[[Context], Array]:
    objects = objects_read(program, schema)

    def points(now: Context) -> Array:
        if unseen_of(now, objects):
            return np.asarray(now.ee_pos[0])
        terms = program(now)
        return np.array([[float(np.asarray(terms[axis]).flat[0]) for axis in "xyz"]])

    return points


def objects_read(program: Cost, schema: Schema) -> tuple[str, ...]:
    """Return the objects whose state a program reads; one that does not declare what it reads waits for nothing."""
    reads = program.reads if isinstance(program, ReadingCost) else []
    state = [name for name in reads if not name.endswith(KNOWN)]
    return tuple(thing for thing in objects_of(schema) if any(f"_{thing}_" in f"_{name}_" for name in state))


def unseen_of(state: Context, objects: Sequence[str]) -> list[str]:
    """Return which of these objects have not been seen yet: the state has a `NAME_guessed` for them, beyond its schema.

    Objects lost on the way are none: a hand that hides what it reaches for would turn back.
    """
    return [name for name in objects if f"{name}_guessed" in state]


def waiting_cost(cost: Callable[[Context], Terms], objects: Sequence[str]) -> Callable[[Context], Terms]:
    """Return a cost that keeps the hand where its stage began while an object that it reads was never seen."""
    if not objects:
        return cost

    def evaluate(state: Context) -> Terms:
        missing = unseen_of(state, objects)
        if not missing:
            return cost(state)
        off = np.linalg.norm(state.ee_pos - state.ee_stage_pos, axis=-1)
        return {f"wait for {', '.join(missing)}": 20.0 * off + 2.0 * np.linalg.norm(state.ee_vel, axis=-1)}

    return evaluate
