"""What an advisor may know of a trial: the task file, shapes, tracked poses and beliefs, never the true parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost.schema import hand_quantities
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

    What all things have is described once, and so is what two things have to do with each other. What is neither a
    vector nor true or false is a number.
    """
    objects = objects_of(schema)
    things = [*objects, *(name for name in _things(schema) if name not in objects)]
    of_hand = [suffix for suffix in hand_quantities("") if all(f"{name}{suffix}" in schema for name in things)]
    pairs = {
        f"{name}_{other}_{kind}" for name in objects for other in things for kind in ("contact", "clearance")
    } & set(schema)
    told = pairs | {f"{name}{suffix}" for name in things for suffix in of_hand}
    rest = [key for key in schema if key not in told]
    own = {name: [key for key in rest if _owner(key, objects) == name] for name in objects}
    shared = [key.removeprefix(name) for name in objects[:1] for key in own[name]]
    shared = [suffix for suffix in shared if all(f"{name}{suffix}" in schema for name in objects)]
    lines = _lines({key: schema[key] for key in rest if not _owner(key, objects)})
    if objects:
        first = objects[0]
        lines.append(f"For each of {', '.join(objects)}, its name in place of NAME:")
        lines += _lines({f"NAME{suffix}": _general(schema[f"{first}{suffix}"], first, "object") for suffix in shared})
    if things and of_hand:
        lines.append(f"For each of {', '.join(things)}:")
        lines += _lines(
            {f"NAME{suffix}": _general(schema[f"{things[0]}{suffix}"], things[0], "thing") for suffix in of_hand}
        )
    if pairs:
        some = next(key for key in schema if key in pairs).rsplit("_", 1)[0]
        lines.append(
            "For an object NAME and any of these OTHER, such as "
            f"self.{some}_contact: self.NAME_OTHER_contact (true or false): whether they touch; "
            "self.NAME_OTHER_clearance (m): shortest distance, 0 where they touch"
        )
    for name in objects:
        lines += _lines({key: schema[key] for key in own[name] if key.removeprefix(name) not in shared})
    return "\n".join([*lines, f"Functions: {FUNCTIONS}."])


def _things(schema: Schema) -> list[str]:
    """Return everything that the hand can touch: objects, table, fixtures."""
    return [name.removesuffix("_hand_contact") for name in schema if name.endswith("_hand_contact")]


def _general(quantity: Quantity, name: str, kind: str) -> Quantity:
    """Describe a quantity of any thing of a kind in place of one of this name."""
    return replace(quantity, text=quantity.text.replace(f"the {name}", f"the {kind}").replace(f"{name}_", "NAME_"))


def _owner(name: str, objects: Sequence[str]) -> str:
    """Return the object that a quantity belongs to; "" if to none. The longest name wins: `box_lid` is not of `box`."""
    return max((thing for thing in objects if name.startswith(f"{thing}_")), key=len, default="")


def _lines(quantities: Schema) -> list[str]:
    """Describe quantities, a line each; the pose at some moment, and what the two fingers touch, have one line."""
    lines: list[str] = []
    for name, quantity in quantities.items():
        size = f"vector of {quantity.size}" if quantity.size else ("true or false" if quantity.truth else "")
        about = ", ".join(part for part in (size, quantity.unit) if part)
        shown = f"self.{name}{f' ({about})' if about else ''}"
        if name.endswith(("_init_quat", "_stage_quat")) and name.replace("_quat", "_pos") in quantities:
            lines[-1] = f"{lines[-1]}; {shown}"
        elif name.endswith("_right_contact") and name.replace("_right", "_left") in quantities:
            lines[-1] = (
                lines[-1].replace(" (", f", self.{name} (", 1).replace("the left finger touches", "that finger touches")
            )
        else:
            lines.append(f"- {shown}: {quantity.text}")
    return lines


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
