"""Trials: poses, masses, frictions and sizes sampled from a task's ranges, and beliefs about them before any answer.

A robot with an advisor sees shapes only. It does not get the ranges of the task file: the truth is sampled from them,
so their middle would give the answer away. Before the first answer it assumes the same material for everything. The
author of a hand-written cost knows the task file, ranges included, and tunes the cost with them: that knowledge is part
of the expert.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from coral.contact.scene.geometry import conjugate, from_rotvec, from_rpy_deg, multiply, rotate, rotation_of
from coral.contact.scene.mesh import mesh_vertices
from coral.contact.scene.observation import Array, BodyState
from coral.contact.scene.shapes import Joint, Movable, Shape
from coral.contact.scene.task import Task
from coral.errors import InputError

SUNK_M = 0.005
"""Tolerance of heights in files, for rounding."""
PRESSED_M = 1e-3
"""Touching things may begin this deep in each other."""
GAP_M = 0.01
DENSITY_KG_M3, FRICTION = 500.0, 0.5
"""Density, hollow space included, and friction on a table of an unknown object: light wood, filled packaging."""


@dataclass(frozen=True)
class PhysicalParameters:
    """The parameters that no camera shows: mass (kg) and friction coefficient."""

    mass_kg: float
    friction: float


@dataclass(frozen=True)
class TrialObject:
    """An object of one trial."""

    scale: Array
    """Shape=(3,) factors on its parts."""
    physical: PhysicalParameters
    """Its true mass and friction."""
    pose: BodyState
    """Its pose at the start."""
    joint_start: float = 0.0
    """Where its joint stands at the start (rad or m); 0 without a joint."""


@dataclass(frozen=True)
class Trial:
    """A task with sampled values for all its ranges."""

    task: Task
    seed: int
    objects: dict[str, TrialObject]

    @property
    def known(self) -> Trial:
        """Return the trial as planner and advisor know it: without hidden fixtures."""
        return replace(self, task=self.task.known)

    def size(self, name: str) -> Array:
        """Return the full extents (m) of the object along its own axes, Shape=(3,)."""
        corners = self.corners(name)
        return np.asarray(corners.max(axis=0) - corners.min(axis=0))

    def corners(self, name: str) -> Array:
        """Return points, Shape=(n, 3), in the object's frame, whose convex hull contains it."""
        return corners(self.task.object(name), self.objects[name].scale)

    def point(self, name: str, point: str | None, body: BodyState) -> Array:
        """Return a named point on the object, in the world, Shape=(3,); None for the origin of its frame."""
        if point is None:
            return body.position
        local = np.asarray(self.task.object(name).points[point]) * self.objects[name].scale
        return np.asarray(body.position + rotate(body.quaternion, local))

    def joint_position(self, name: str, body: BodyState) -> float:
        """Compute where the object's joint stands (rad or m); 0 is how the task file places the object."""
        start, joint = self.objects[name], self.task.object(name).joint
        assert joint is not None, f"{name} has no joint"
        return start.joint_start + joint_motion(joint, start.pose, body)

    def lowest_point(self, name: str, body: BodyState) -> float:
        """Return the height (m) of the object's lowest point above the table's top."""
        return float(body.position[2] + (self.corners(name) @ rotation_of(body.quaternion).T)[:, 2].min())


def part_scale(part: Shape, scale: Array) -> Array:
    """Convert the object's scale factors, along its axes, to factors along a part's own axes, Shape=(3,).

    They scale the part's unit vectors. Round shapes grow evenly in their round directions, and a part that is neither
    aligned with the object nor scaled evenly keeps its right angles.
    """
    turned = rotation_of(from_rpy_deg(part.rpy_deg))
    own = np.sqrt(np.square(scale) @ np.square(turned))
    if part.shape == "cylinder":
        own[:2] = np.sqrt(own[0] * own[1])
    elif part.shape == "sphere":
        own[:] = float(np.prod(own)) ** (1 / 3)
    return np.asarray(own)


def part_size(part: Shape, scale: Array) -> Array:
    """Return the full size of a part (m; for a mesh, its factors) under the object's scale."""
    return np.asarray(part.size) * part_scale(part, scale)


def corners(item: Movable, scale: Array) -> Array:
    """Return points, Shape=(n, 3), in the object's frame, whose convex hull contains it (16 points per rim)."""
    found = []
    for part in item.parts:
        half = part_size(part, scale) / 2
        if part.shape == "mesh":
            local = mesh_vertices(part) * part_scale(part, scale)
        elif part.shape == "cylinder":
            turns = np.arange(16) * np.pi / 8
            rim = np.stack([half[0] * np.cos(turns), half[0] * np.sin(turns), np.full(16, half[2])], axis=1)
            local = np.concatenate([rim, rim * np.array([1, 1, -1])])
        else:
            local = box_corners(2 * half)
        placed = local @ rotation_of(from_rpy_deg(part.rpy_deg)).T + np.asarray(part.position) * scale
        found.append(placed)
    return np.concatenate(found)


def sample_trial(task: Task, seed: int, where: str = "") -> Trial:
    """Sample a trial; the same task and seed give the same trial on every machine. `where` is for errors.

    Raises:
        InputError: No placement without overlap in a hundred attempts, or an object begins inside the table.
    """
    where = where or f"task {task.name}"
    rng = np.random.default_rng([seed, *task.name.encode()])
    clash = None
    for _ in range(100):
        objects: dict[str, TrialObject] = {}
        for item in _from_below(task):
            objects[item.name] = _sample_object(item, task, objects, rng)
        trial = Trial(task, seed, {item.name: objects[item.name] for item in task.objects})
        _check_heights(trial, where)
        clash = _find_clash(trial)
        if clash is None:
            return trial
    expected = "ranges of x, y and yaw_deg with room for all beside each other, or stands_on for one on top of another"
    raise InputError(where, "objects", f"{clash} in each other's place", expected)


def _from_below(task: Task) -> list[Movable]:
    """Order the objects so that what stands on another one comes after it."""
    found: list[Movable] = []
    left = list(task.objects)
    while left:
        ready = [item for item in left if item.stands_on is None or item.stands_on in [one.name for one in found]]
        found += ready
        left = [item for item in left if item not in ready]
    return found


def _sample_object(
    item: Movable, task: Task, placed: Mapping[str, TrialObject], rng: np.random.Generator
) -> TrialObject:
    scale = np.array([rng.uniform(*axis) for axis in item.scale])
    physical = PhysicalParameters(float(rng.uniform(*item.mass_kg)), float(rng.uniform(*item.friction)))
    x, y, yaw = rng.uniform(*item.x), rng.uniform(*item.y), np.radians(rng.uniform(*item.yaw_deg))
    quaternion = multiply(from_rotvec([0, 0, yaw]), from_rpy_deg(item.rpy_deg))
    floor = 0.0
    if item.stands_on is not None:
        below = placed[item.stands_on]
        at, turn = below.pose.position, rotation_of(below.pose.quaternion)
        top = corners(task.object(item.stands_on), below.scale) @ turn.T + at
        x, y, floor = x + at[0], y + at[1], float(top[:, 2].max())
    z = item.z if item.z is not None else floor - (corners(item, scale) @ rotation_of(quaternion).T)[:, 2].min()
    pose = BodyState(np.array([x, y, z]), quaternion)
    if item.joint is None:
        return TrialObject(scale, physical, pose)
    start = rng.uniform(*item.joint.start) * (np.pi / 180 if item.joint.kind == "hinge" else 1.0)
    return TrialObject(scale, physical, move_joint(item.joint, pose, start), start)


def _check_heights(trial: Trial, where: str) -> None:
    for index, item in enumerate(trial.task.objects):
        lowest = trial.lowest_point(item.name, trial.objects[item.name].pose)
        if item.z is not None and item.joint is None and lowest < -SUNK_M:
            found = f"{item.z:g}, which is {-lowest:.3g} m deep in the table"
            raise InputError(where, f"objects[{index}].z", found, "a height at which it lies on the table or above")


def _find_clash(trial: Trial) -> str | None:
    """Name two objects that are too close, or an object inside a fixture; None if there are none.

    Objects that the ranges scatter over the table are `GAP_M` apart. One whose height the file gives, by `z` or
    `stands_on`, was placed on purpose: it may touch the others, as in a stack, or stand in a hollow of another.
    """
    placed = {
        name: trial.corners(name) @ rotation_of(item.pose.quaternion).T + item.pose.position
        for name, item in trial.objects.items()
    }
    names = list(placed)
    scattered = [item.name for item in trial.task.objects if item.z is None and item.stands_on is None]
    for k, name in enumerate(names):
        for other in names[k + 1 :]:
            apart = GAP_M if name in scattered and other in scattered else -PRESSED_M
            if not _separated(placed[name], placed[other], np.eye(3), apart) and (
                apart > 0 or _parts_clash(trial, name, other)
            ):
                return f"{name} and {other}"
        for fixture in trial.task.fixtures if trial.task.object(name).joint is None else ():
            turn = rotation_of(from_rotvec([0, 0, np.radians(fixture.yaw_deg)]))
            walls = box_corners(np.asarray(fixture.size)) @ turn.T + fixture.position
            # It may stand on a fixture or against it, but not in it.
            if not _separated(placed[name], walls, np.concatenate([np.eye(3), turn.T]), -PRESSED_M):
                return f"{name} and {fixture.name}"
    return None


def _parts_clash(trial: Trial, first: str, second: str) -> bool:
    """Check whether any part of an object is in a part of the other one."""

    def boxes(name: str) -> list[tuple[Array, Array]]:
        item, found = trial.task.object(name), trial.objects[name]
        turn = rotation_of(found.pose.quaternion)
        return [
            (
                corners(item.model_copy(update={"parts": (part,)}), found.scale) @ turn.T + found.pose.position,
                (turn @ rotation_of(from_rpy_deg(part.rpy_deg))).T,
            )
            for part in item.parts
        ]

    return any(
        not _separated(one, other, np.concatenate([np.eye(3), axes, others]), -PRESSED_M)
        for one, axes in boxes(first)
        for other, others in boxes(second)
    )


def _separated(first: Array, second: Array, axes: Array, gap_m: float) -> bool:
    """Check whether two point sets, Shape=(n, 3), are separated by the gap along one of the axes, Shape=(m, 3)."""
    a, b = first @ axes.T, second @ axes.T
    return bool(np.any((b.min(axis=0) - a.max(axis=0) >= gap_m) | (a.min(axis=0) - b.max(axis=0) >= gap_m)))


def box_corners(size: Array) -> Array:
    """Return the corners, Shape=(8, 3), of a box with these full edges, centred at the origin."""
    return np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * (size / 2)


def with_beliefs(trial: Trial, beliefs: Mapping[str, PhysicalParameters]) -> Trial:
    """Replace the true masses and frictions of a trial by beliefs."""
    objects = {name: replace(item, physical=beliefs[name]) for name, item in trial.objects.items()}
    return replace(trial, objects=objects)


def prior_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """Return the beliefs of a robot that sees only shapes: volume of the box times one density, and one friction."""
    return {
        name: PhysicalParameters(mass_kg=DENSITY_KG_M3 * float(np.prod(trial.size(name))), friction=FRICTION)
        for name in trial.objects
    }


def stated_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """Return the beliefs of an expert's author: the middle of the task file's ranges."""
    return {
        item.name: PhysicalParameters(mass_kg=float(np.mean(item.mass_kg)), friction=float(np.mean(item.friction)))
        for item in trial.task.objects
    }


def joint_axis(joint: Joint, pose: BodyState) -> Array:
    """Compute the joint's axis in the world, a unit vector, Shape=(3,)."""
    return rotate(pose.quaternion, np.asarray(joint.axis) / np.linalg.norm(joint.axis))


def joint_motion(joint: Joint, start: BodyState, body: BodyState) -> float:
    """Compute how far the joint has moved (rad or m) between two poses of its object, as near as it can."""
    axis = joint_axis(joint, start)
    if joint.kind == "slide":
        return float((body.position - start.position) @ axis)
    turn = multiply(body.quaternion, conjugate(start.quaternion))
    angle = 2.0 * np.arctan2(turn[1:] @ axis, turn[0])
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def joint_speed(joint: Joint, start: BodyState, body: BodyState) -> float:
    """Compute the joint's speed (rad/s or m/s) from the velocity of its object."""
    velocity = body.velocity if joint.kind == "slide" else body.angular_velocity
    return float(velocity @ joint_axis(joint, start))


def move_joint(joint: Joint, pose: BodyState, by: float) -> BodyState:
    """Compute the pose, at rest, that an object has after its joint has moved by `by` (rad or m)."""
    axis = joint_axis(joint, pose)
    if joint.kind == "slide":
        return BodyState(pose.position + by * axis, pose.quaternion)
    turn = from_rotvec(axis * by)
    arm = rotate(pose.quaternion, np.asarray(joint.point))
    return BodyState(pose.position + arm - rotate(turn, arm), multiply(turn, pose.quaternion))
