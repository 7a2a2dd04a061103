"""Quantities of one task: the names that its costs may read, and the values that are constant in a rollout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from coral.contact.cost.context import Quantity
from coral.contact.cost.schema import HAND, object_quantities, scenery_quantities
from coral.contact.scene.observation import Array, Observation
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters, Trial


def constants(
    trial: Trial, start: Observation, beliefs: Sequence[Mapping[str, PhysicalParameters]], total: int
) -> dict[str, Array]:
    """Return the values constant in an episode: sizes, beliefs, initial poses, places and numbers of the task."""
    task = trial.task
    found: dict[str, Array] = {}
    for item in task.objects:
        name, body = item.name, start.objects[item.name]
        found[f"{name}_init_pos"] = body.position[None, None]
        found[f"{name}_init_quat"] = body.quaternion[None, None]
        found[f"{name}_size"] = trial.size(name)[None, None]
        masses, frictions = zip(*((one[name].mass_kg, one[name].friction) for one in beliefs), strict=True)
        found[f"{name}_mass"] = np.repeat(np.array(masses), total // len(beliefs))[:, None]
        found[f"{name}_friction"] = np.repeat(np.array(frictions), total // len(beliefs))[:, None]
    half = np.asarray(task.table.size) / 2
    center: Array = np.array([*task.table.center, 0.0])
    found["table_min"] = (center - np.array([half[0], half[1], 2 * half[2]]))[None, None]
    found["table_max"] = (center + np.array([half[0], half[1], 0.0]))[None, None]
    for fixture in task.fixtures:
        found[f"{fixture.name}_pos"] = np.asarray(fixture.position)[None, None]
        found[f"{fixture.name}_size"] = np.asarray(fixture.size)[None, None]
    for name, place in task.places.items():
        found[f"{name}_pos"] = np.asarray(place)[None, None]
    for name, number in task.numbers.items():
        found[name] = np.full((1, 1), number)
    return found


def stage_constants(began: Observation) -> dict[str, Array]:
    """Return the values constant in a stage: where hand and objects were when it began."""
    found: dict[str, Array] = {"ee_stage_pos": began.tool.position[None, None]}
    for name, body in began.objects.items():
        found[f"{name}_stage_pos"] = body.position[None, None]
        found[f"{name}_stage_quat"] = body.quaternion[None, None]
    return found


def task_schema_of(task: Task) -> dict[str, Quantity]:
    """Describe names and units of all quantities that a cost for this task may read."""
    schema = dict(HAND)
    for item in task.objects:
        others = [other.name for other in task.objects if other.name != item.name]
        schema |= object_quantities(item.name, item.points, task.things, others, item.joint.kind if item.joint else "")
    schema |= scenery_quantities((item.name for item in task.fixtures), task.places, task.numbers)
    return schema
