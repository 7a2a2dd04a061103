"""Checks across the fields of a task file: clashing names, objects off the table, meshes that cannot be read."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from coral.contact.cost.schema import HAND, object_quantities, scenery_quantities
from coral.contact.scene.condition import check_known
from coral.contact.scene.mesh import mesh_vertices
from coral.contact.scene.state_conditions import At, Resting
from coral.contact.scene.trial import corners
from coral.errors import InputError

if TYPE_CHECKING:
    from coral.contact.scene.shapes import Movable
    from coral.contact.scene.task import Task

RESERVED = {
    **dict.fromkeys(("hand", "left", "right", "robot", "palm", "wrist"), "a part of the robot"),
    **dict.fromkeys(("tool", "ee", "gripper", "left_finger", "right_finger"), "a part of the robot"),
    "table": "the table",
    **dict.fromkeys(("world", "target"), "a body of the simulation"),
    "self": "the state in a cost program",
    **dict.fromkeys(("cmd", "event", "step", "t"), "a column of the run's logs"),
    **dict.fromkeys(("source", "attempts", "refused", "failure"), "a field of the run's logs"),
}
"""Names that models, costs and records use already, and for what."""
SMALLEST_M, LARGEST_M = 0.001, 5
"""Bounds of a mesh's edges."""
RESERVED_BEGINNINGS = ("robot0", "gripper0", "mount0", "fixed_mount0", "left_eef", "right_eef")
"""Prefixes of the names of robosuite's bodies."""


def check_task(task: Task, where: str) -> None:
    """Check that the parts of a task fit together.

    Raises:
        InputError: They do not fit; the error names the field.
    """
    _check_names(task, where)
    for index, item in enumerate(task.objects):
        _check_place(task, item, where, f"objects[{index}]")
        _check_meshes(item, where, f"objects[{index}]")
    for index, mark in enumerate(task.marks):
        check_known(mark.place, task.places, where, f"marks[{index}].place")
    if task.success.hold_s > task.time_limit_s:
        expected = f"no more than the time limit, {task.time_limit_s:g} s"
        raise InputError(where, "success.hold_s", f"{task.success.hold_s:g} s", expected)
    for index, condition in enumerate(task.success.conditions):
        condition.check(task.known, where, f"success.conditions[{index}]")
    _check_goal_heights(task, where)


def _check_goal_heights(task: Task, where: str) -> None:
    """Refuse a place above all heights at which its object can touch the fixed thing that it is to rest on."""
    tops = {"table": 0.0, **{one.name: one.position[2] + one.size[2] / 2 for one in task.fixtures}}
    conditions = task.success.conditions
    resting = {one.object: one.thing for one in conditions if isinstance(one, Resting) and one.thing in tops}
    for goal in (one for one in conditions if isinstance(one, At) and "z" in one.axes and one.point is None):
        if goal.object not in resting:
            continue
        item, thing = task.object(goal.object), resting[goal.object]
        reach_m = float(np.linalg.norm(corners(item, np.array([axis[1] for axis in item.scale])), axis=1).max())
        highest, z = tops[thing] + reach_m + goal.tolerance_m, task.places[goal.place][2]
        if z > highest:
            expected = f"at most {highest:.2f} m, where the {goal.object} can rest on the {thing}"
            raise InputError(where, f"places.{goal.place}[2]", f"{z:g}", expected)


def _check_names(task: Task, where: str) -> None:
    taken = dict(RESERVED)
    names = [(f"fixtures[{index}].name", fixture.name) for index, fixture in enumerate(task.fixtures)]
    names += [(f"objects[{index}].name", item.name) for index, item in enumerate(task.objects)]
    for field, name in names:
        meaning = taken.get(name, "a part of the robot" if name.startswith(RESERVED_BEGINNINGS) else None)
        if meaning is not None:
            raise InputError(where, field, repr(name), f"a name that is not taken: this one is {meaning}")
        taken[name] = f"also {field}"
    # Costs read all quantities by flat names such as box_pos: no two may be the same.
    others = [item.name for item in task.objects]
    of_table = scenery_quantities()
    found = [(key, "") for key in (*HAND, *of_table)]
    for index, fixture in enumerate(task.fixtures):
        own = [key for key in scenery_quantities([fixture.name]) if key not in of_table]
        found += [(key, f"fixtures[{index}].name") for key in own]
    for index, item in enumerate(task.objects):
        held = item.joint.kind if item.joint else ""
        beside = [name for name in others if name != item.name]
        keys = object_quantities(item.name, item.points, task.things, beside, held)
        found += [(key, f"objects[{index}].name") for key in keys]
        touched = len(task.things) + len(beside)  # each has a contact and a clearance
        if len(keys) < len(object_quantities(item.name, joint=held)) + len(item.points) + 2 * touched:
            expected = "points named unlike init and what an object has by itself"
            raise InputError(where, f"objects[{index}].points", ", ".join(item.points), expected)
    found += [(f"{name}_pos", f"places.{name}") for name in task.places]
    found += [(name, f"numbers.{name}") for name in task.numbers]
    count = Counter(key for key, _ in found)
    for key, field in reversed(found):
        if count[key] > 1:
            raise InputError(where, field, f"a second meaning of {key}", "a name that is not taken")


def _check_place(task: Task, item: Movable, where: str, field: str) -> None:
    if item.stands_on is not None:
        check_known(item.stands_on, [one.name for one in task.objects if one is not item], where, f"{field}.stands_on")
        below, seen = item, set()
        while below.stands_on is not None and below.stands_on in [one.name for one in task.objects]:
            if below.name in seen:
                raise InputError(where, f"{field}.stands_on", item.stands_on, "a stack that ends on the table")
            seen.add(below.name)
            below = task.object(below.stands_on)
    if item.z is not None or item.stands_on is not None:
        return
    table = task.table
    for axis, ends in (("x", item.x), ("y", item.y)):
        k = "xy".index(axis)
        low, high = table.center[k] - table.size[k] / 2, table.center[k] + table.size[k] / 2
        if not low <= ends[0] <= ends[1] <= high:
            raise InputError(where, f"{field}.{axis}", list(ends), f"on the table, from {low:g} to {high:g}")


def _check_meshes(item: Movable, where: str, field: str) -> None:
    for index, part in enumerate(item.parts):
        if part.file is None:
            continue
        place = f"{field}.parts[{index}].file"
        if Path(part.file).suffix.lower() not in (".stl", ".obj") or not Path(part.file).is_file():
            raise InputError(where, place, part.file, "an STL or OBJ file, its path relative to the task file")
        try:
            vertices = mesh_vertices(part)
        except InputError as error:
            raise InputError(where, place, f"{Path(part.file).name} ({error.found})", error.expected) from None
        extents = vertices.max(axis=0) - vertices.min(axis=0)
        if not (extents >= SMALLEST_M).all() or not (extents <= LARGEST_M).all():
            found = f"factors that make the mesh {' x '.join(f'{extent:.3g}' for extent in extents)} m large"
            expected = f"edges from {SMALLEST_M} to {LARGEST_M} m"
            raise InputError(where, f"{field}.parts[{index}].size", found, expected)
