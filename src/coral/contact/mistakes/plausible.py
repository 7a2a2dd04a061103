"""Plausible errors of a model that plans contact tasks, for the advisor `sloppy`: wrong answers that look right."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from coral.advisor.question import Question
from coral.advisor.setting import Answer, Earlier, Err, Mistake
from coral.contact.mistakes import program_edits as edit

PLANS = ("cost-function", "cost-repair", "unified")
REGIONS = ("contact-regions", "unified")
PARAMETERS = ("physical-parameters", "parameter-repair", "unified")
SPREAD = math.log(10.0) / 2
"""Standard deviation of the logarithm of a guessed mass or friction: two of them are a factor of ten."""
MOST = math.log(10.0)
"""Maximum error of that logarithm: a factor of ten."""
OFF_M = (0.03, 0.08)
"""Range of the error of a misread place."""

Edit = Callable[[str, np.random.Generator], str | None]


def _change_one_stage(change: Edit) -> Err:
    """Make a mistake that changes the cost of one stage; stages are tried in random order."""

    def err(
        question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
    ) -> Answer | None:
        wrong = copy.deepcopy(right)
        stages = wrong["stages"] or [wrong]
        for index in rng.permutation(len(stages)):
            code = change(stages[index]["code"], rng)
            if code is not None:
                stages[index]["code"] = code
                return wrong
        return None

    return err


def _mistake_object(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Replace one object by another throughout the plan."""
    names = list(question.facts["objects"])
    used = [name for name in names if any(f"self.{name}_" in stage["code"] for stage in right["stages"] or [right])]
    if not used or len(names) < 2:
        return None
    one = used[int(rng.integers(len(used)))]
    other = [name for name in names if name != one][int(rng.integers(len(names) - 1))]
    return _change_programs(right, lambda code: edit.rename_quantities(code, one, other))


def _mirror(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Mirror the plan in the object's frame: its long axis points backwards."""
    made = (_change_programs(right, partial(edit.turn_axis, axis=int(axis))) for axis in rng.permutation(2))
    return next((one for one in made if one is not None), None)


def _tighten_condition(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Tighten the condition that ends a stage until no motion fulfils it."""
    wrong = copy.deepcopy(right)
    for index in rng.permutation(len(wrong["stages"])):
        stage = wrong["stages"][index]
        strict = edit.tighten(stage["done"]) if stage["done"] else None
        if strict is not None:
            stage["done"] = strict
            return wrong
    return None


def _lift_early(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Drop the stage that closes the fingers: the hand rises with open fingers."""
    closing = [k for k, stage in enumerate(right["stages"]) if stage["name"] in ("close", "pinch", "grasp")]
    if not closing:
        return None
    wrong = copy.deepcopy(right)
    gone = wrong["stages"].pop(closing[0])["name"]
    for stage in wrong["stages"]:
        stage["next"].pop(gone, None)
    return wrong


def _misjudge(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Multiply every mass and friction by a random factor, within the physically possible bounds only."""
    wrong = copy.deepcopy(right)
    told = wrong["objects"] if question.kind == "parameter-repair" else (wrong.get("parameters") or wrong)
    for item in told if isinstance(told, list) else told.values():
        for key in ("mass", "mass_kg", "friction", "friction_coeff"):
            if item.get(key) is not None:
                item[key] = float(item[key]) * math.exp(float(np.clip(SPREAD * rng.standard_normal(), -MOST, MOST)))
    return wrong


def _move_face(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Move the regions of one object to another face of its box: the opposite or the next one."""
    wrong = copy.deepcopy(right)
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


def _ways(stage: Answer) -> list[tuple[Answer, str]]:
    """Return the conditions on which a stage leads on to others, as places to change."""
    ways = stage.get("next") or {}
    return [(ways, to) for to in ways]


def _change_programs(right: Answer, change: Callable[[str], str | None]) -> Answer | None:
    """Change every program of a plan; None if nothing changes."""
    wrong, changed = copy.deepcopy(right), False
    for stage in wrong["stages"] or [wrong]:
        for held, key in [*((stage, key) for key in ("code", "done", "toward")), *_ways(stage)]:
            text = held.get(key)
            made = change(text) if text else None
            if made is not None:
                held[key], changed = made, True
    return wrong if changed else None


CONTACT_MISTAKES = (
    Mistake(
        name="sign",
        what="a term of a cost has the wrong sign",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_change_one_stage(edit.flip_sign),
    ),
    Mistake(
        name="weight",
        what="a term's weight is off by ten",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_change_one_stage(edit.scale_term),
    ),
    Mistake(
        name="missing-term",
        what="a term is missing from a cost",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_change_one_stage(edit.drop_term),
    ),
    Mistake(
        name="wrong-object",
        what="one object is taken for another in the plan",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_mistake_object,
    ),
    Mistake(
        name="wrong-side",
        what="the plan works at another side of the object",
        found_in="What's “up” with vision-language models?, arXiv:2310.19785: models fail on basic spatial relations, "
        "left of and right of among them",
        questions=PLANS,
        part="plan",
        err=_mirror,
    ),
    Mistake(
        name="goal-off",
        what="a place in a cost is off by 3 to 8 cm",
        found_in="Q-Spatial Bench, arXiv:2409.09788: distances are hard to tell for all models that were tried",
        questions=PLANS,
        part="plan",
        err=_change_one_stage(lambda code, rng: edit.shift_place(code, rng, OFF_M)),
    ),
    Mistake(
        name="never-done",
        what="the condition on which a phase ends never comes true",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_tighten_condition,
    ),
    Mistake(
        name="early-lift",
        what="the phase that closes the fingers is left out: the lift comes before a grasp",
        found_in="",
        questions=PLANS,
        part="plan",
        err=_lift_early,
    ),
    Mistake(
        name="parameters",
        what="masses and frictions are off by log-normal factors of up to ten",
        found_in="CoRAL (manipulation), limitations: a misjudged material makes the estimate of an object's "
        "mass grossly wrong",
        questions=PARAMETERS,
        part="parameters",
        err=_misjudge,
    ),
    Mistake(
        name="wrong-face",
        what="contact regions lie on the wrong face of an object",
        found_in="",
        questions=REGIONS,
        part="regions",
        err=_move_face,
    ),
)
"""Errors that can be named after `sloppy:`."""
