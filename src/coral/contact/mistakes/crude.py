"""Common errors of models in contact tasks, for the advisor `fallible`: right answers with one error of a kind."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.advisor.question import Question
from coral.advisor.setting import Corrupt

Answer = dict[str, Any]


def spoil(error: str, question: Question[Any], answer: Answer, rng: np.random.Generator) -> Answer:
    """Put one error into an answer.

    Args:
        error: "wrong_type", "out_of_range", "backward", or "stale" if there is nothing earlier to repeat.
        question: The question.
        answer: The right answer as JSON.
        rng: Chooses the place of the error.
    """
    spoilt = copy.deepcopy(answer)
    if question.kind in ("cost-function", "cost-repair", "unified"):
        _plan(error, spoilt, rng)
    elif question.kind == "contact-regions":
        _regions(error, spoilt, rng)
    elif question.kind == "object-poses":
        _poses(error, spoilt, rng)
    else:
        _parameters(error, spoilt, rng)
    return spoilt


def _plan(error: str, answer: Answer, rng: np.random.Generator) -> None:
    """Spoil a plan: text for a number; an unknown quantity; a constant cost; truncated code."""
    stage = answer["stages"][int(rng.integers(len(answer["stages"])))] if answer.get("stages") else answer
    head, _, body = stage["code"].partition("\n")
    wrong = {
        "wrong_type": f"{head}\n    return 'low'",
        "out_of_range": f"{head}\n    x = self.gripper_xyz\n{body}",
        "backward": f"{head}\n    return 1.0",
    }
    stage["code"] = wrong.get(error, stage["code"].rstrip()[:-1] + " +")


def _regions(error: str, answer: Answer, rng: np.random.Generator) -> None:
    """Spoil regions: words for a place; a point off the surface; an inward normal; an unknown object."""
    name = _draw_name(answer, rng)
    if name is None or not answer[name]["regions"]:
        return
    region = answer[name]["regions"][int(rng.integers(len(answer[name]["regions"])))]
    if error == "wrong_type":
        region["center"] = "on top"
    elif error == "out_of_range":
        region["center"] = [round(float(v) + 0.2, 4) for v in region["center"]]
    elif error == "backward":
        region["normal"] = [-v for v in region["normal"]]
    else:
        answer["gripper"] = answer.pop(name)


def _poses(error: str, answer: Answer, rng: np.random.Generator) -> None:
    """Spoil poses: words for a place; a place off the table; a place below it; an unknown object."""
    name = _draw_name(answer, rng)
    if name is None:
        return
    if error == "wrong_type":
        answer[name]["position"] = "left of the middle"
    elif error in ("out_of_range", "backward"):
        axis, by = (0, 3.0) if error == "out_of_range" else (2, -0.5)
        answer[name]["position"][axis] += by
    else:
        answer["gripper"] = answer.pop(name)


def _parameters(error: str, answer: Answer, rng: np.random.Generator) -> None:
    """Spoil parameters: words for a mass; grams taken for kilograms; a negative mass; an unknown object."""
    items = {one["label"]: one for one in answer["objects"]} if "label" in str(answer.get("objects", "")) else answer
    name = _draw_name(items, rng)
    if name is None:
        return
    key = "mass_kg" if "mass_kg" in items[name] else "mass"
    if error == "wrong_type":
        items[name][key] = "rather light"
    elif error in ("out_of_range", "backward"):
        items[name][key] *= 1000.0 if error == "out_of_range" else -1.0
    elif items is answer:
        answer["gripper"] = answer.pop(name)
    else:
        items[name]["label"] = "gripper"


def _draw_name(answer: Mapping[str, Any], rng: np.random.Generator) -> str | None:
    return sorted(answer)[int(rng.integers(len(answer)))] if answer else None


KINDS = (
    "physical-parameters",
    "cost-function",
    "contact-regions",
    "cost-repair",
    "parameter-repair",
    "object-poses",
    "unified",
)
SPOILT: Mapping[str, Corrupt] = dict.fromkeys(KINDS, spoil)
"""Functions that spoil answers, by kind of question."""
