"""Generated variations of a task: another place in front of the robot, other sizes, one more object on the table."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.task import Task
from coral.contact.scene.task_validation import check_task

Array = NDArray[np.float64]
SHIFT_M = 0.04
"""The scene moves by at most this much, away from the robot or towards it and to either side."""
FACTORS = (0.9, 1.1)
"""Sizes of free objects, along each axis: a block of 7 cm still fits between the fingers."""
BYSTANDER_M = 0.04
"""Edge of the cube that is added."""
FROM_EDGE_M = 0.1
"""Distance of the cube from two edges of the table."""
_VARIED = re.compile(r"(?P<task>.+)~(?P<number>[1-9][0-9]{0,5})")
_ROUND_IN_PLANE = ("square-box", "cube", "cylinder", "sphere")


def split_variation(name: str) -> tuple[str, int]:
    """Split a name such as `push-gently~2` into the task's and the number of its variation; 0 for the task itself."""
    found = _VARIED.fullmatch(name)
    return (name, 0) if found is None else (found["task"], int(found["number"]))


def vary_task(task: Task, number: int) -> Task:
    """Vary a task. The same task and number give the same variation on every machine.

    The whole scene, with its table, its places and the regions of its conditions, is moved; free objects are scaled; a
    cube stands in the table's emptiest corner. The goal, its tolerances and the instruction stay.

    Args:
        task: The task.
        number: Number of the variation, 1 or more.

    Raises:
        InputError: The variation is no valid task.
    """
    rng = np.random.default_rng([number, *task.name.encode()])
    content = task.model_dump()
    _move(content, rng.uniform(-SHIFT_M, SHIFT_M, 2).round(3))
    for item in content["objects"]:
        factors = rng.uniform(*FACTORS, 3).round(2)
        if item["joint"] is None and item["z"] is None:
            _scale(item, factors)
    if len(content["objects"]) < 8 and all(item["name"] != "bystander" for item in content["objects"]):
        content["objects"] = (*content["objects"], _bystander(content))
    content["title"] = f"{task.title[:60]}, variation {number}"
    varied = Task.model_validate(content)
    check_task(varied, f"task {task.name}~{number}")
    return varied


def _move(content: dict[str, Any], shift: Array) -> None:
    """Move a scene in the plane (m)."""
    content["table"]["center"] = tuple(np.add(content["table"]["center"], shift).round(9).tolist())
    for item in content["fixtures"]:
        item["position"] = _moved(item["position"], shift)
    for item in content["objects"]:
        if item["stands_on"] is None:
            item["x"], item["y"] = (
                tuple((np.array(item[axis]) + by).round(9).tolist()) for axis, by in zip("xy", shift, strict=True)
            )
    content["places"] = {name: _moved(at, shift) for name, at in content["places"].items()}
    for condition in _all_conditions(content["success"]["conditions"]):
        if condition["kind"] == "inside":
            condition["low"], condition["high"] = (_moved(condition[end], shift) for end in ("low", "high"))


def _moved(point: Iterable[float], shift: Array) -> tuple[float, ...]:
    return tuple(np.add(list(point), [*shift, 0.0]).round(9).tolist())


def _all_conditions(conditions: Iterable[dict[str, Any]]) -> Iterable[dict[str, Any]]:
    """Yield conditions, and those of the events of a sequence."""
    for condition in conditions:
        yield condition
        for event in condition.get("events", ()):
            yield from _all_conditions(event)


def _scale(item: dict[str, Any], factors: Array) -> None:
    """Scale an object; what looks the same from two sides still does."""
    if item["symmetry"] in _ROUND_IN_PLANE or any(part["shape"] in ("cylinder", "sphere") for part in item["parts"]):
        factors[1] = factors[0]
    if item["symmetry"] in ("cube", "sphere") or any(part["shape"] == "sphere" for part in item["parts"]):
        factors[2] = factors[0]
    item["scale"] = tuple(
        (low * by, high * by) for (low, high), by in zip(item["scale"], factors.tolist(), strict=True)
    )


def _bystander(content: dict[str, Any]) -> dict[str, Any]:
    """Return a cube for the corner of the table that is farthest from everything else."""
    size, center = np.array(content["table"]["size"][:2]), np.array(content["table"]["center"])
    corners = center + (size / 2 - FROM_EDGE_M) * np.array([(1, 1), (1, -1), (-1, 1), (-1, -1)])
    taken = [np.mean([item["x"], item["y"]], axis=1) for item in content["objects"] if item["stands_on"] is None]
    taken += [np.array(item["position"][:2]) for item in content["fixtures"]]
    taken += [np.array(place[:2]) for place in content["places"].values()]
    room = np.linalg.norm(corners[:, None] - np.array(taken), axis=-1).min(axis=1)
    x, y = corners[room.argmax()].tolist()
    return {
        "name": "bystander",
        "label": "grey cube",
        "parts": ({"size": (BYSTANDER_M,) * 3},),
        "mass_kg": 0.1,
        "friction": 0.6,
        "x": x,
        "y": y,
        "symmetry": "cube",
        "color": (0.45, 0.45, 0.47),
    }
