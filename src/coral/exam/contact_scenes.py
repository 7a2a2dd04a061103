"""Scenes for contact questions: shipped tasks with objects of known materials, named by their labels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import BodyState
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters, Trial, TrialObject, part_size, sample_trial

STATED_KG, STATED_FRICTION = (0.005, 20.0), (0.02, 2.0)
"""The ranges that the changed tasks state for every object: all that the task format allows, so they reveal nothing."""
WIDER_M = 0.05
"""Objects may lie this much farther out than in the shipped task."""
JITTER = 0.1
"""Standard deviation of the logarithms of density and friction about the material's values."""


@dataclass(frozen=True)
class Material:
    """Handbook values of a solid material: density (kg/m3), coefficient of sliding friction on a table, colour."""

    label: str
    density_kg_m3: float
    friction: float
    color: tuple[float, float, float]


MATERIALS = (
    Material("polystyrene foam", 30.0, 0.55, (0.95, 0.95, 0.93)),
    Material("cork", 200.0, 0.6, (0.76, 0.58, 0.38)),
    Material("pine wood", 500.0, 0.4, (0.86, 0.70, 0.46)),
    Material("rubber", 1150.0, 0.95, (0.16, 0.16, 0.17)),
    Material("solid plastic", 1050.0, 0.3, (0.25, 0.45, 0.75)),
    Material("brick", 1900.0, 0.65, (0.66, 0.31, 0.24)),
    Material("granite stone", 2700.0, 0.6, (0.45, 0.44, 0.44)),
    Material("aluminium", 2700.0, 0.4, (0.78, 0.79, 0.80)),
    Material("solid steel", 7850.0, 0.45, (0.55, 0.57, 0.60)),
    Material("ice", 917.0, 0.05, (0.80, 0.90, 0.95)),
)


def made_of(task: Task, seed: int) -> Trial:
    """Make a trial of a task in which every object is solid and of one material.

    Args:
        task: A shipped task.
        seed: Chooses materials, places and sizes.
    """
    rng = np.random.default_rng([seed, 41, *task.name.encode()])
    objects, materials = [], {}
    for item in task.objects:
        material = MATERIALS[int(rng.integers(len(MATERIALS)))]
        materials[item.name] = material
        objects.append(
            item.model_copy(
                update={
                    "label": f"{material.label} {item.name}",
                    "mass_kg": STATED_KG,
                    "friction": STATED_FRICTION,
                    "color": material.color,
                    "x": (item.x[0] - WIDER_M, item.x[1] + WIDER_M),
                    "y": (item.y[0] - WIDER_M, item.y[1] + WIDER_M),
                }
            )
        )
    trial = sample_trial(task.model_copy(update={"objects": tuple(objects)}), seed)
    physical = {}
    for name, material in materials.items():
        density, friction = np.array([material.density_kg_m3, material.friction]) * np.exp(JITTER * rng.normal(size=2))
        physical[name] = PhysicalParameters(
            mass_kg=float(np.clip(density * _volume(trial, name), *STATED_KG)), friction=float(friction)
        )
    return replace(
        trial,
        objects={
            name: replace(item, physical=physical[name], pose=_flip_pose(trial, name, bool(rng.random() < 0.5)))
            for name, item in trial.objects.items()
        },
    )


def looks_like(trial: Trial, name: str) -> str:
    """Return the apparent symmetry of an object: a plain box looks like a box, whatever its task states."""
    item = trial.task.object(name)
    plain = [part.shape for part in item.parts] == ["box"]
    return "box" if plain and item.symmetry == "none" else str(item.symmetry)


def trial_to_json(trial: Trial) -> dict[str, Any]:
    """Convert a trial to plain values for JSON."""
    return {
        "task": trial.task.model_dump(mode="json"),
        "seed": trial.seed,
        "objects": {
            name: {
                "scale": [float(v) for v in item.scale],
                "mass_kg": item.physical.mass_kg,
                "friction": item.physical.friction,
                "position": [float(v) for v in item.pose.position],
                "quaternion": [float(v) for v in item.pose.quaternion],
                **({"joint_start": item.joint_start} if item.joint_start else {}),
            }
            for name, item in trial.objects.items()
        },
    }


def trial_from_json(given: Mapping[str, Any]) -> Trial:
    """Restore the trial that `trial_to_json` wrote."""
    return Trial(
        Task.model_validate(given["task"]),
        int(given["seed"]),
        {
            name: TrialObject(
                np.array(item["scale"]),
                PhysicalParameters(item["mass_kg"], item["friction"]),
                BodyState(np.array(item["position"]), np.array(item["quaternion"])),
                float(item.get("joint_start", 0.0)),
            )
            for name, item in given["objects"].items()
        },
    )


def _flip_pose(trial: Trial, name: str, half: bool) -> BodyState:
    """Return the object's pose, turned by half a turn about the vertical if asked for and if it then looks the same.

    Otherwise the face that a task wants touched would always be the same one in the object's frame.
    """
    pose = trial.objects[name].pose
    if not half or looks_like(trial, name) not in ("box", "square-box", "cube"):
        return pose
    return replace(pose, quaternion=multiply(from_rotvec([0.0, 0.0, math.pi]), pose.quaternion))


def _volume(trial: Trial, name: str) -> float:
    """Compute the volume of an object's parts (m3)."""
    share = {"box": 1.0, "cylinder": math.pi / 4, "sphere": math.pi / 6}
    item = trial.task.object(name)
    return sum(share[p.shape] * float(np.prod(part_size(p, trial.objects[name].scale))) for p in item.parts)
