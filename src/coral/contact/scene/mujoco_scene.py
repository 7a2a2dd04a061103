"""Adds the table, the fixtures and the objects of a trial to a MuJoCo model. All simulated worlds use it."""

from __future__ import annotations

import logging
from collections.abc import Iterable

import mujoco
import numpy as np

from coral.contact.scene.geometry import from_rotvec, from_rpy_deg
from coral.contact.scene.shapes import Movable, Shape
from coral.contact.scene.trial import Trial, TrialObject, part_size

# MuJoCo's default for a warning is to print it and to write a file into the working directory.
mujoco.set_mju_user_warning(logging.getLogger(__name__).debug)

OBJECT_PRIORITY = 1
"""An object's friction overrides that of table and walls: it is the one that the robot estimates."""
FINGER_PRIORITY = 2
FINGER_FRICTION = 1.0
"""Rubber pads; between finger and object the pads' friction counts."""
TORSION, ROLLING = 0.005, 0.0001

_GEOMS = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}


def add_scene(spec: mujoco.MjSpec, trial: Trial, condim: int = 4) -> None:
    """Add the table, fixtures and objects of a trial.

    The table's geom is "table", a fixture's has its name. An object's body has its name, its free joint is "NAME_free"
    and its geoms are "NAME/0", "NAME/1", ...

    Args:
        spec: The model to add to.
        trial: The trial.
        condim: Contact dimension of objects: 3 slides only, 4 also resists twisting.
    """
    task = trial.task
    table = task.table
    spec.worldbody.add_geom(
        name="table",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=np.asarray(table.size) / 2,
        pos=[*table.center, -table.size[2] / 2],
        friction=[0.5, TORSION, ROLLING],
        rgba=[0.82, 0.78, 0.72, 1],
    )
    for fixture in task.fixtures:
        spec.worldbody.add_geom(
            name=fixture.name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=np.asarray(fixture.size) / 2,
            pos=fixture.position,
            quat=from_rotvec([0, 0, np.radians(fixture.yaw_deg)]),
            friction=[fixture.friction, TORSION, ROLLING],
            rgba=[*fixture.color, 1],
        )
    for item in task.objects:
        _add_object(spec, item, trial.objects[item.name], condim)


def _add_object(spec: mujoco.MjSpec, item: Movable, found: TrialObject, condim: int) -> None:
    body = spec.worldbody.add_body(name=item.name, pos=found.pose.position, quat=found.pose.quaternion)
    body.add_freejoint(name=f"{item.name}_free")
    volumes = np.array([_volume(part, found.scale) for part in item.parts])
    for index, (part, share) in enumerate(zip(item.parts, volumes / volumes.sum(), strict=True)):
        size = part_size(part, found.scale)
        geom = body.add_geom(
            name=f"{item.name}/{index}",
            type=_GEOMS[part.shape],
            pos=np.asarray(part.position) * found.scale,
            quat=from_rpy_deg(part.rpy_deg),
            mass=found.physical.mass_kg * share,
            condim=condim,
            priority=OBJECT_PRIORITY,
            friction=[found.physical.friction, TORSION, ROLLING],
            rgba=[*item.color, 1],
        )
        if part.shape == "box":
            geom.size = size / 2
        elif part.shape == "cylinder":
            geom.size = [size[0] / 2, size[2] / 2, 0]
        elif part.shape == "sphere":
            geom.size = [size[0] / 2, 0, 0]
        else:
            mesh = spec.add_mesh(name=f"{item.name}/{index}", file=str(part.file))
            mesh.scale = size
            geom.meshname = mesh.name


def _volume(part: Shape, scale: np.ndarray) -> float:
    """Compute the volume of a part; the mass is divided in this proportion."""
    factor = {"box": 1.0, "cylinder": np.pi / 4, "sphere": np.pi / 6, "mesh": 0.5}[part.shape]
    return factor * float(np.prod(part_size(part, scale)))


def contact_pairs(trial: Trial) -> Iterable[tuple[str, str]]:
    """Yield the pairs (object, fixture or other object) whose contact a cost may read."""
    names = [item.name for item in trial.task.objects]
    for name in names:
        for thing in trial.task.things:
            yield name, thing
        for other in names:
            if other != name:
                yield name, other
