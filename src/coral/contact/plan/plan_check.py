"""Check of a plan before the planner follows it: all faults at once, each beside its line, and advice."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from coral.advisor.question import Rejection
from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.cost.context import Context, Schema
from coral.contact.cost_program import CostError
from coral.contact.plan.barrier_check import CostFault
from coral.contact.plan.cost_check import verify_cost
from coral.contact.plan.cost_plan import Compiled, Loader, PlanAnswer, compile_stage, in_process

STIFFNESS_N_M = (50.0, 3000.0)
NOISE = (0.05, 3.0)
OPENING_M = (SQUEEZE_M, MAX_OPENING_M)
OF_THE_PLACE = ("unreachable", "barrier")
"""Faults that depend on where things stand: a later stage has them only where it begins."""
Beginnings = Callable[[Sequence[Compiled]], Mapping[str, Context]]
"""States around those in which the later stages begin, by the stage's name; a stage that is never reached has none."""


@dataclass(frozen=True)
class PlanVerdict:
    """The verdict on a plan."""

    refusal: Rejection | None
    """Why the plan cannot be used; None if it can."""
    advice: tuple[str, ...] = ()
    """What its author should know although it is no reason to refuse the plan."""


def judge_plan(
    answer: PlanAnswer,
    schema: Schema,
    states: Context,
    load: Loader = in_process,
    beginnings: Beginnings | None = None,
) -> PlanVerdict:
    """Judge a plan: its stages, its programs, and their values on rolled-out states, of which the first is the present.

    `beginnings` finds the states in which later stages begin; it is asked only if a later stage looks wrong in the
    present state. Without it, later stages are judged by what holds in every state.
    """
    structure = structure_faults(answer)
    compiled, broken = _compile_each(answer, schema, load)
    found = structure + broken
    unsure: set[str] = set()
    first = answer.begin or answer.names[0]
    for made in compiled:
        name = made.answer.name
        every = (*verify_cost(made.cost, states), *_condition_faults(made, states))
        faults = [replace(fault, stage=name) for fault in every]
        if name == first:
            found += faults
            continue
        found += [fault for fault in faults if fault.code not in OF_THE_PLACE]
        if any(fault.code in OF_THE_PLACE for fault in faults):
            unsure.add(name)
    if unsure and beginnings is not None and not any(one.fatal for one in found):
        begun = beginnings(compiled)
        for made in compiled:
            name = made.answer.name
            if name in unsure and name in begun:
                found += [
                    replace(fault, stage=name)
                    for fault in verify_cost(made.cost, begun[name])
                    if fault.code in OF_THE_PLACE
                ]
    return _verdict(answer, found)


def structure_faults(answer: PlanAnswer) -> list[CostFault]:
    """Return the faults of a plan's stages, apart from their programs."""
    names, stages, faults = answer.names, answer.each(), []
    for name in sorted({name for name in names if names.count(name) > 1}):
        faults.append(f"two stages have the same name, {name!r}: give each its own")
    for stage in stages:
        where = f"stage {stage.name!r}"
        for to in stage.next:
            if to not in names:
                faults.append(f"{where}: next leads to {to!r}, which is none of {', '.join(names)}")
        if not STIFFNESS_N_M[0] <= stage.stiffness <= STIFFNESS_N_M[1]:
            low, high = STIFFNESS_N_M
            faults.append(f"{where}: stiffness is {stage.stiffness:g}; it lies within {low:g} and {high:g} N/m")
        if stage.opening is not None and not OPENING_M[0] <= stage.opening <= OPENING_M[1]:
            low, high = OPENING_M
            faults.append(f"{where}: opening is {stage.opening:g}; it lies within {low:g} and {high:g} m")
        if not NOISE[0] <= stage.noise <= NOISE[1]:
            faults.append(f"{where}: noise is {stage.noise:g}; it lies within {NOISE[0]:g} and {NOISE[1]:g}")
        if stage is not stages[-1] and not stage.done and not stage.next and answer.stages:
            faults.append(f"{where} never ends, so that those after it never begin: say when it is done")
    if answer.begin and answer.begin not in names:
        faults.append(f"it begins with {answer.begin!r}, which is none of {', '.join(names)}")
    return [CostFault("stages", 0, text) for text in faults]


def _compile_each(answer: PlanAnswer, schema: Schema, load: Loader) -> tuple[list[Compiled], list[CostFault]]:
    """Compile the stages; those that cannot be compiled are faults."""
    compiled, broken = [], []
    for stage in answer.each():
        try:
            compiled.append(compile_stage(stage, schema, load))
        except CostError as error:
            broken.append(CostFault(error.code, error.line, str(error), stage=stage.name))
    return compiled, broken


def _condition_faults(made: Compiled, states: Context) -> list[CostFault]:
    """Return the faults of a stage's conditions and of its point on rolled-out states."""
    faults = []
    ways = ((f"next.{to}", way) for to, way in made.next.items())
    for field, program in (("done", made.done), *ways, ("toward", made.toward)):
        if program is None:
            continue
        try:
            program(states)
        except CostError as error:
            faults.append(CostFault(error.code, 0, f"`{field}`: {error.text}"))
    return faults


def _verdict(answer: PlanAnswer, found: Sequence[CostFault]) -> PlanVerdict:
    def told(one: CostFault) -> str:
        return f"stage {one.stage!r}: {one.reason}" if one.stage and answer.stages else one.reason

    fatal = [one for one in found if one.fatal]
    advice = tuple(told(one) for one in found if not one.fatal)
    if not fatal:
        return PlanVerdict(None, advice)
    reasons = [told(one) for one in fatal]
    reason = reasons[0] if len(reasons) == 1 else " ".join(f"({k}) {text}" for k, text in enumerate(reasons, 1))
    if advice:
        reason += f" Also worth knowing, though no reason to refuse: {'; '.join(advice)}."
    details = {"stage": fatal[0].stage, "faults": [one.code for one in fatal]}
    listing = list_program(answer, fatal)
    return PlanVerdict(Rejection(code=fatal[0].code, reason=reason, details=details, listing=listing), advice)


def list_program(answer: PlanAnswer, faults: Sequence[CostFault]) -> str:
    """Return the stages that have faults with numbered lines, each fault below its line."""
    lines = []
    for stage in answer.each():
        own = [one for one in faults if one.stage == stage.name]
        if not own:
            continue
        lines.append(f"stage {stage.name!r}")
        for number, text in enumerate(stage.code.split("\n"), 1):
            lines.append(f"{number:3d} | {text}")
            lines += [f"    ^ {fault.code}" for fault in own if fault.line == number]
        ways = {f"next {to!r}": test for to, test in stage.next.items()}
        shown = {"done": stage.done, **ways, "toward": stage.toward}
        lines += [f"    {field}: {text}" for field, text in shown.items() if text]
    return "\n".join(lines)
