"""What an advisor may know of a trial: the task file, shapes, tracked poses and beliefs, never the true parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.scene.facts import AreaFacts, ObjectFacts, SceneFacts, goals_of
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.scene.trial import PhysicalParameters, Trial, part_size


def scene_facts(trial: Trial, now: Observation, beliefs: Mapping[str, PhysicalParameters] | None = None) -> SceneFacts:
    """Describe the scene in plain numbers: metres, kilograms, quaternions (w, x, y, z), world frame.

    Only shapes are read from the trial. Masses and frictions are the believed ones, and missing before an estimate.
    """
    task = trial.task
    objects: dict[str, ObjectFacts] = {}
    for item in task.objects:
        name, factors = item.name, trial.objects[item.name].scale
        objects[name] = {
            "label": item.label or name,
            "size_m": rounded(trial.size(name)),
            "pose": pose(now.objects[name]),
            "shapes": sorted({part.shape for part in item.parts}),
            "solid_share": round(_solid_share(trial, name), 3),
            "parts": [
                {"size_m": rounded(part_size(part, factors)), "position": rounded(np.asarray(part.position) * factors)}
                for part in item.parts
                if part.shape != "mesh" and not any(part.rpy_deg)
            ],
            "points": {point: rounded(np.asarray(at) * factors) for point, at in item.points.items()},
        }
        corners = trial.corners(name)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        if np.abs(middle).max() > 0.001:
            objects[name]["middle_m"] = rounded(middle)
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
        if name in now.unseen:
            objects[name]["unseen"] = True
            if item.stands_on is None and item.joint is None:  # otherwise they count from there
                objects[name]["somewhere"] = {"x": list(item.x), "y": list(item.y)}
        if name in now.lost:
            objects[name]["lost"] = True
        if beliefs is not None:
            objects[name]["mass_kg"] = round(beliefs[name].mass_kg, 5)
            objects[name]["friction"] = round(beliefs[name].friction, 4)
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
        "table": table_facts(trial),
        "hand": {
            "pose": pose(now.tool),
            "opening_m": max(0.0, round(now.opening_m, 3)),
            "widest_opening_m": MAX_OPENING_M,
        },
    }


def table_facts(trial: Trial) -> AreaFacts:
    """Return from where to where the table's top reaches (m)."""
    (x, y), (length, width, _) = trial.task.table.center, trial.task.table.size
    return {"x": [x - length / 2, x + length / 2], "y": [y - width / 2, y + width / 2]}


def pose(body: BodyState) -> list[float]:
    """Return x, y, z, qw, qx, qy, qz."""
    return [*rounded(body.position), *rounded(body.quaternion)]


def rounded(values: Any) -> list[float]:
    """Return a vector as prompts and events show it."""
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
