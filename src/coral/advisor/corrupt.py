"""Corrupting an answer, given its schema and the facts of its question."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from coral.advisor.question import Question


def corrupt(error: str, question: Question[Any], answer: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """Make another answer with one kind of error.

    Args:
        error: "wrong_type", "out_of_range", "backward" or "stale" (with no earlier answer to repeat).
        question: The schema of its answer type bounds numbers; its facts (`n_centroids`, `centroids`, `robot`) bound
            indices and show what lies behind the robot.
        answer: The right answer as JSON.
        rng: Chooses the error.
    """
    spoilt = dict(answer)
    numbers = _number_fields(question)
    if not numbers:
        # There is no count to corrupt: drop a field instead.
        for field in list(spoilt)[:1]:
            del spoilt[field]
        return spoilt
    name = sorted(numbers)[int(rng.integers(len(numbers)))]
    if error == "wrong_type":
        spoilt[name] = ["the nearest one", [], {"value": 1}, "two or three"][int(rng.integers(4))]
    elif error == "out_of_range":
        spoilt[name] = _exceed_range(name, numbers[name], question, rng)
    else:
        spoilt.update(_lead_back(numbers, question, rng))
    return spoilt


def _number_fields(question: Question[Any]) -> dict[str, dict[str, Any]]:
    """Return the number fields at the top of the answer's schema: name to the schema of the number."""
    fields = {}
    for name, schema in question.answer_type.model_json_schema().get("properties", {}).items():
        for choice in (schema, *schema.get("anyOf", ())):
            if choice.get("type") in ("integer", "number"):
                fields[name] = choice
    return fields


def _exceed_range(name: str, schema: dict[str, Any], question: Question[Any], rng: np.random.Generator) -> int:
    """Return a number just outside its range."""
    more = int(rng.integers(1, 6))
    if "index" in name and (count := _option_count(question)) is not None:
        return count - 1 + more
    if "maximum" in schema:
        return math.floor(float(schema["maximum"])) + more
    if "minimum" in schema:
        return math.ceil(float(schema["minimum"])) - more
    return 10**6 * more


def _option_count(question: Question[Any]) -> int | None:
    """Return the number of options, from facts such as `n_centroids` or `centroids`."""
    for key, value in question.facts.items():
        if key.startswith("n_") and isinstance(value, int):
            return value
    for value in question.facts.values():
        if isinstance(value, list | tuple) and value and isinstance(value[0], dict) and "index" in value[0]:
            return len(value)
    return None


def _lead_back(numbers: dict[str, dict[str, Any]], question: Question[Any], rng: np.random.Generator) -> dict[str, Any]:
    """Return field values that lead back: behind the robot, or to where it has been."""
    for name in numbers:
        if "forward" in name:
            return {name: -int(rng.integers(1, 7))}
    indices = [name for name in numbers if "index" in name]
    if not indices:
        return dict.fromkeys(list(numbers)[:1], 0)
    centroids = question.facts.get("centroids") or []
    behind = [c["index"] for c in centroids if _is_behind(c, question.facts.get("robot"))]
    choices = behind or [c["index"] for c in centroids if c.get("visited")] or [0]
    return {indices[0]: choices[int(rng.integers(len(choices)))]}


def _is_behind(centroid: Any, robot: Any) -> bool:
    """Check whether a centroid of the facts lies behind the robot, as far as the facts show it."""
    if "forward_m" in centroid:
        return bool(centroid["forward_m"] < 0)
    if not robot or "x" not in centroid:
        return False
    c, s = math.cos(robot["theta"]), math.sin(robot["theta"])
    return bool((centroid["x"] - robot["x"]) * c + (centroid["y"] - robot["y"]) * s < 0)
