"""Adds the table, the fixtures and the objects of a trial to a MuJoCo model, and tells the gap between two geoms."""

from __future__ import annotations

import logging
from collections.abc import Iterable

import mujoco
import numpy as np

from coral.contact.scene.geometry import from_rotvec, from_rpy_deg, rotation_of
from coral.contact.scene.mesh import add_mesh
from coral.contact.scene.observation import Array
from coral.contact.scene.shapes import Joint, Movable, Shape
from coral.contact.scene.trial import Trial, TrialObject, part_size

# MuJoCo's default for a warning is to print it and to write a file into the working directory.
mujoco.set_mju_user_warning(logging.getLogger(__name__).debug)

ROLLING_CONDIM = 6
"""Contact dimension that also resists rolling; it costs more than sliding alone, so only round parts have it."""
OBJECT_PRIORITY = 1
"""An object's friction overrides that of table and walls: it is the one that the robot estimates."""
FINGER_PRIORITY = 2
FINGER_FRICTION = 1.0
"""Rubber pads; between finger and object the pads' friction counts."""
TORSION, ROLLING = 0.005, 0.0001
ROUND_ROLLING = 0.0005
"""Rolling friction (m) of round parts and meshes: without it a bottle on its side creeps on for ever."""
HARD_FRICTION = [0.999, 0.9999, 0.001, 0.5, 2.0]
"""Impedance of joint friction: with MuJoCo's own a drawer held by friction creeps with a centimetre per second."""
JOINT_DAMPING = {"hinge": 0.02, "slide": 1.0}
"""Viscous damping of joints, N m s or N s/m, besides their friction."""

_GEOMS = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}
TABLE_COLOR = (0.82, 0.78, 0.72)
MARK_M, MARK_GROUP = 0.001, 1
"""Thickness of a mark, and its group: pictures for people and models show it, the tracker's, of depth, do not."""
_AGREE_M = 1e-6
_TURNS = [rotation_of(from_rotvec(turn * axis)) for turn in (1e-4, -1e-4, 1e-3, -1e-3) for axis in np.eye(3)]


def add_scene(spec: mujoco.MjSpec, trial: Trial, condim: int = 4) -> None:
    """Add the table, fixtures and objects of a trial.

    The table's geom is "table", a fixture's has its name. An object's body has its name, its free joint is "NAME_free"
    and its geoms are "NAME/0", "NAME/1", ... Their contact dimension is 3, which slides only, or 4, which also resists
    twisting.
    """
    task = trial.task
    table = task.table
    spec.worldbody.add_geom(
        name="table",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=np.asarray(table.size) / 2,
        pos=[*table.center, -table.size[2] / 2],
        friction=[0.5, TORSION, ROLLING],
        rgba=[*TABLE_COLOR, 1],
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
    for mark in task.marks:
        spec.worldbody.add_geom(
            name=f"mark/{mark.place}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[mark.size[0] / 2, mark.size[1] / 2, MARK_M / 2],
            pos=[*task.places[mark.place][:2], MARK_M / 2],
            contype=0,
            conaffinity=0,
            group=MARK_GROUP,
            rgba=[*mark.color, 1],
        )
    for item in task.objects:
        _add_object(spec, item, trial.objects[item.name], condim)


def _add_object(spec: mujoco.MjSpec, item: Movable, found: TrialObject, condim: int) -> None:
    body = spec.worldbody.add_body(name=item.name, pos=found.pose.position, quat=found.pose.quaternion)
    if item.joint is None:
        body.add_freejoint(name=f"{item.name}_free")
    else:
        _add_joint(spec, body, item.joint, found)
    volumes = np.array([_volume(part, found.scale) for part in item.parts])
    for index, (part, share) in enumerate(zip(item.parts, volumes / volumes.sum(), strict=True)):
        size = part_size(part, found.scale)
        geom = body.add_geom(
            name=f"{item.name}/{index}",
            type=_GEOMS[part.shape],
            pos=np.asarray(part.position) * found.scale,
            quat=from_rpy_deg(part.rpy_deg),
            mass=found.physical.mass_kg * share,
            condim=condim if part.shape == "box" else ROLLING_CONDIM,
            priority=OBJECT_PRIORITY,
            friction=[found.physical.friction, TORSION, ROLLING if part.shape == "box" else ROUND_ROLLING],
            rgba=[*(part.color or item.color), 1],
        )
        if part.shape == "box":
            geom.size = size / 2
        elif part.shape == "cylinder":
            geom.size = [size[0] / 2, size[2] / 2, 0]
        elif part.shape == "sphere":
            geom.size = [size[0] / 2, 0, 0]
        else:
            add_mesh(spec, geom.name, part, size)
            geom.meshname = geom.name


def _add_joint(spec: mujoco.MjSpec, body: mujoco.MjsBody, joint: Joint, found: TrialObject) -> None:
    hinge = joint.kind == "hinge"
    in_radians = hinge and not spec.compiler.degree
    body.add_joint(
        name=f"{body.name}_joint",
        type=mujoco.mjtJoint.mjJNT_HINGE if hinge else mujoco.mjtJoint.mjJNT_SLIDE,
        axis=np.asarray(joint.axis) / np.linalg.norm(joint.axis),
        pos=joint.point,
        range=np.radians(joint.range) if in_radians else joint.range,
        limited=True,
        ref=np.degrees(found.joint_start) if hinge and not in_radians else found.joint_start,
        frictionloss=joint.friction,
        damping=JOINT_DAMPING[joint.kind],
        solimp_friction=HARD_FRICTION,
    )
    # The range keeps it from what it is built into: a drawer would jam on the walls of its chest.
    spec.add_exclude(bodyname1="world", bodyname2=body.name)


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


def geom_gap(
    model: mujoco.MjModel, data: mujoco.MjData, one: int, other: int, within_m: float
) -> tuple[float, Array, Array]:
    """Return the signed distance (m) of two geoms, and the nearest points on each, Shape=(3,), world frame.

    Up to MuJoCo 3.10 `mj_geomDistance` answers 0 for one pair of separate boxes in 25 (measured; issue 3383 of MuJoCo).
    Its points contradict it then, and with one geom turned by 0.0001 rad it finds the distance.

    The geoms' poses are read from `data`. If they are farther apart than `within_m`, it is returned, with meaningless
    points.
    """
    ends, before = np.zeros(6), data.geom_xmat[one].copy()
    for turn in (None, *_TURNS):
        if turn is not None:
            data.geom_xmat[one] = (before.reshape(3, 3) @ turn).reshape(9)
        distance = float(mujoco.mj_geomDistance(model, data, one, other, within_m, ends))
        if distance >= within_m or abs(np.linalg.norm(ends[3:] - ends[:3]) - abs(distance)) < _AGREE_M:
            break
    data.geom_xmat[one] = before
    return distance, ends[:3].copy(), ends[3:].copy()
