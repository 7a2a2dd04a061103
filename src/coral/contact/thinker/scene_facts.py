"""What an advisor may know of a trial: the task file, shapes, tracked poses and beliefs, never the true parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost_program.state import objects_of
from coral.contact.scene.facts import ObjectFacts, SceneFacts, goals_of
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.scene.trial import PhysicalParameters, Trial, part_size

FUNCTIONS = (
    "norm(v), dot(a, b), cross(a, b), clip(x, low, high), clip01(x), sigmoid(x), near(distance, scale) = "
    "exp(-(distance/scale)^2), quat_axis(q, 0|1|2) = that axis in the world, quat_rotate(q, v), "
    "quat_angle(a, b), and the usual ones of np and math"
)


def scene_facts(trial: Trial, now: Observation, beliefs: Mapping[str, PhysicalParameters] | None = None) -> SceneFacts:
    """Describe the scene in plain numbers: metres, kilograms, quaternions (w, x, y, z), world frame.

    Args:
        trial: The trial; only shapes are read from it.
        now: The latest observation.
        beliefs: Believed masses and frictions; None before the first estimate.
    """
    task = trial.task
    objects: dict[str, ObjectFacts] = {}
    for item in task.objects:
        name = item.name
        factors = trial.objects[name].scale
        objects[name] = {
            "label": item.label or name,
            "size_m": _round(trial.size(name)),
            "pose": pose(now.objects[name]),
            "shapes": sorted({part.shape for part in item.parts}),
            "solid_share": round(_solid_share(trial, name), 3),
            "parts": [
                {"size_m": _round(part_size(part, factors)), "position": _round(np.asarray(part.position) * factors)}
                for part in item.parts
                if part.shape != "mesh" and not any(part.rpy_deg)
            ],
            "points": {point: _round(np.asarray(at) * factors) for point, at in item.points.items()},
        }
        corners = trial.corners(name)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        if np.abs(middle).max() > 0.001:
            objects[name]["middle_m"] = _round(middle)
        if item.joint is not None:
            at = trial.joint_position(name, now.objects[name])
            objects[name]["joint"] = {
                "kind": item.joint.kind,
                "axis": list(item.joint.axis),
                "point": list(item.joint.point),
                "range": list(item.joint.range),
                "now": round(float(np.degrees(at)) if item.joint.kind == "hinge" else at, 4),
                "friction": item.joint.friction,
            }
        if beliefs is not None:
            objects[name]["mass_kg"] = round(beliefs[name].mass_kg, 5)
            objects[name]["friction"] = round(beliefs[name].friction, 4)
    table = task.table
    return {
        "task": task.name,
        "instruction": task.instruction,
        "goals": goals_of(task.success.conditions),
        "objects": objects,
        "fixtures": {
            item.name: {"position": list(item.position), "size_m": list(item.size), "yaw_deg": item.yaw_deg}
            for item in task.fixtures
        },
        "places": {name: list(at) for name, at in task.places.items()},
        "numbers": dict(task.numbers),
        "table": {
            "x": [table.center[0] - table.size[0] / 2, table.center[0] + table.size[0] / 2],
            "y": [table.center[1] - table.size[1] / 2, table.center[1] + table.size[1] / 2],
        },
        "hand": {"pose": pose(now.tool), "widest_opening_m": MAX_OPENING_M},
    }


def pose(body: BodyState) -> list[float]:
    """Return x, y, z, qw, qx, qy, qz."""
    return [*_round(body.position), *_round(body.quaternion)]


def interface_text(schema: Schema) -> str:
    """Describe the names and functions that a cost may use, as text for a prompt.

    What all objects have is described once. What is neither a vector nor true or false is a number.
    """
    objects = objects_of(schema)
    own = {
        name: [key for key in schema if key.startswith(f"{name}_") and _owner(key, objects) == name] for name in objects
    }
    shared = [key.removeprefix(f"{name}_") for name in objects[:1] for key in own[name]]
    shared = [suffix for suffix in shared if all(f"{name}_{suffix}" in schema for name in objects)]
    lines = [_quantity_line(key, schema[key]) for key in schema if not _owner(key, objects)]
    if objects:
        lines.append(f"For each of {', '.join(objects)}, its name in place of NAME:")
        lines += [
            _quantity_line(f"NAME_{suffix}", schema[f"{objects[0]}_{suffix}"])
            .replace(f"the {objects[0]}", "the object")
            .replace(f"{objects[0]}_", "NAME_")
            for suffix in shared
        ]
    for name in objects:
        rest = [key for key in own[name] if key.removeprefix(f"{name}_") not in shared]
        contacts = [key for key in rest if schema[key].truth]
        lines += [_quantity_line(key, schema[key]) for key in rest if key not in contacts]
        if contacts:
            lines.append(f"- {', '.join(f'self.{key}' for key in contacts)} (true or false): whether the two touch")
    return "\n".join([*lines, f"Functions: {FUNCTIONS}."])


def _owner(name: str, objects: Sequence[str]) -> str:
    """Return the object that a quantity belongs to; "" if to none. The longest name wins: `box_lid` is not of `box`."""
    return max((thing for thing in objects if name.startswith(f"{thing}_")), key=len, default="")


def _quantity_line(name: str, quantity: Quantity) -> str:
    size = f"vector of {quantity.size}" if quantity.size else ("true or false" if quantity.truth else "")
    about = ", ".join(part for part in (size, quantity.unit) if part)
    return f"- self.{name}{f' ({about})' if about else ''}: {quantity.text}"


def _round(values: Any) -> list[float]:
    return [round(float(value), 5) for value in values]


def _solid_share(trial: Trial, name: str) -> float:
    """Compute the volume of an object's parts as a share of its bounding box, at most 1."""
    item = trial.task.object(name)
    factors = {"box": 1.0, "cylinder": np.pi / 4, "sphere": np.pi / 6}
    scale = trial.objects[name].scale
    volume = sum(
        factors[part.shape] * float(np.prod(np.asarray(part.size) * scale))
        for part in item.parts
        if part.shape != "mesh"
    )
    box = float(np.prod(trial.size(name)))
    return min(1.0, volume / box if volume else 0.6)
