"""Plausible errors of a model that plans contact tasks, for the advisor `sloppy`: wrong answers that look right."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from coral.advisor.question import Question
from coral.advisor.setting import Answer, Earlier, Mistake
from coral.contact.mistakes import program_edits as edit

PLANS = ("cost-function", "cost-repair", "unified")
QUESTIONS = {
    "plan": PLANS,
    "regions": ("contact-regions", "unified"),
    "parameters": ("physical-parameters", "parameter-repair", "unified"),
}
"""Kinds of question by the part of their answers that a mistake spoils."""
SPREAD = math.log(10.0) / 2
"""Standard deviation of the logarithm of a guessed mass or friction: two of them are a factor of ten."""
MOST = math.log(10.0)
"""Maximum error of that logarithm: a factor of ten."""
OFF_M = (0.03, 0.08)
"""Range of the error of a misread place."""

Edit = Callable[[str, np.random.Generator], str | None]
Spoil = Callable[[Question[Any], Answer, np.random.Generator], Answer | None]
"""Changes a copy of the right answer; None if this mistake is impossible here."""


def _mistake(name: str, what: str, spoil: Spoil, part: str = "plan", found_in: str = "") -> Mistake:
    def err(
        question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
    ) -> Answer | None:
        return spoil(question, copy.deepcopy(right), rng)

    return Mistake(name=name, what=what, found_in=found_in, questions=QUESTIONS[part], part=part, err=err)


def _change_one_stage(change: Edit) -> Spoil:
    """Make a mistake that changes the cost of one stage; stages are tried in random order."""

    def spoil(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
        stages = wrong["stages"] or [wrong]
        for index in rng.permutation(len(stages)):
            code = change(stages[index]["code"], rng)
            if code is not None:
                stages[index]["code"] = code
                return wrong
        return None

    return spoil


def _mistake_object(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Replace one object by another throughout the plan."""
    names = list(question.facts["objects"])
    used = [name for name in names if any(f"self.{name}_" in stage["code"] for stage in wrong["stages"] or [wrong])]
    if not used or len(names) < 2:
        return None
    one = used[int(rng.integers(len(used)))]
    other = [name for name in names if name != one][int(rng.integers(len(names) - 1))]
    return _change_programs(wrong, lambda code: edit.rename_quantities(code, one, other))


def _mirror(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Mirror the plan in the object's frame: its long axis points backwards."""
    made = (_change_programs(wrong, partial(edit.turn_axis, axis=int(axis))) for axis in rng.permutation(2))
    return next((one for one in made if one is not None), None)


def _tighten_condition(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Tighten the condition that ends a stage until no motion fulfils it."""
    for index in rng.permutation(len(wrong["stages"])):
        stage = wrong["stages"][index]
        strict = edit.tighten(stage["done"]) if stage["done"] else None
        if strict is not None:
            stage["done"] = strict
            return wrong
    return None


def _lift_early(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Drop the stage that closes the fingers: the hand rises with open fingers."""
    closing = [k for k, stage in enumerate(wrong["stages"]) if stage["name"] in ("close", "pinch", "grasp")]
    if not closing:
        return None
    gone = wrong["stages"].pop(closing[0])["name"]
    for stage in wrong["stages"]:
        stage["next"].pop(gone, None)
    return wrong


def _misjudge(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Multiply every mass and friction by a random factor, within the physically possible bounds only."""
    told = wrong["objects"] if question.kind == "parameter-repair" else (wrong.get("parameters") or wrong)
    for item in told if isinstance(told, list) else told.values():
        for key in ("mass", "mass_kg", "friction", "friction_coeff"):
            if item.get(key) is not None:
                item[key] = float(item[key]) * math.exp(float(np.clip(SPREAD * rng.standard_normal(), -MOST, MOST)))
    return wrong


def _move_face(question: Question[Any], wrong: Answer, rng: np.random.Generator) -> Answer | None:
    """Move the regions of one object to another face of its box: the opposite or the next one."""
    held = wrong["regions"] if question.kind == "unified" else wrong
    names = [name for name in held if held[name]["regions"]]
    if not names:
        return None
    name = names[int(rng.integers(len(names)))]
    item = question.facts["objects"][name]
    middle = np.asarray(item.get("middle_m", [0.0, 0.0, 0.0]))
    half = np.asarray(item["size_m"]) / 2
    opposite = rng.random() < 0.5
    for region in held[name]["regions"]:
        center, normal = np.asarray(region["center"]) - middle, np.asarray(region["normal"])
        axis = int(np.abs(normal).argmax())
        if opposite and axis != 2:
            center[axis], normal = -center[axis], -normal
        else:
            # Rotate by a quarter turn about the vertical, or from top to side; keep the relative position on the face.
            to = 0 if axis == 2 else 1 - axis
            share = center / half
            share[axis], share[to] = share[to], math.copysign(1.0, share[axis])
            center = share * half
            turned = np.zeros(3)
            turned[to] = share[to]
            normal = turned
        region["center"] = [round(float(v), 4) for v in center + middle]
        region["normal"] = [float(v) + 0.0 for v in normal]
    return wrong


def _change_programs(wrong: Answer, change: Callable[[str], str | None]) -> Answer | None:
    """Change every program of a plan; None if nothing changes."""
    changed = False
    for stage in wrong["stages"] or [wrong]:
        ways = stage.get("next") or {}
        for held, key in [*((stage, key) for key in ("code", "done", "toward")), *((ways, to) for to in ways)]:
            text = held.get(key)
            made = change(text) if text else None
            if made is not None:
                held[key], changed = made, True
    return wrong if changed else None


CONTACT_MISTAKES = (
    _mistake("sign", "a term of a cost has the wrong sign", _change_one_stage(edit.flip_sign)),
    _mistake("weight", "a term's weight is off by ten", _change_one_stage(edit.scale_term)),
    _mistake("missing-term", "a term is missing from a cost", _change_one_stage(edit.drop_term)),
    _mistake("wrong-object", "one object is taken for another in the plan", _mistake_object),
    _mistake(
        "wrong-side",
        "the plan works at another side of the object",
        _mirror,
        found_in="What's “up” with vision-language models?, arXiv:2310.19785: models fail on basic spatial relations, "
        "left of and right of among them",
    ),
    _mistake(
        "goal-off",
        "a place in a cost is off by 3 to 8 cm",
        _change_one_stage(lambda code, rng: edit.shift_place(code, rng, OFF_M)),
        found_in="Q-Spatial Bench, arXiv:2409.09788: distances are hard to tell for all models that were tried",
    ),
    _mistake("never-done", "the condition on which a phase ends never comes true", _tighten_condition),
    _mistake("early-lift", "the phase that closes the fingers is left out: the lift comes before a grasp", _lift_early),
    _mistake(
        "parameters",
        "masses and frictions are off by log-normal factors of up to ten",
        _misjudge,
        "parameters",
        "CoRAL (manipulation), limitations: a misjudged material makes the estimate of an object's mass grossly wrong",
    ),
    _mistake("wrong-face", "contact regions lie on the wrong face of an object", _move_face, "regions"),
)
"""Errors that can be named after `sloppy:`."""
