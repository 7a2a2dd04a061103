"""One trial of a task: poses, masses, frictions and sizes drawn from the task's ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.geometry import from_rotvec, from_rpy_deg, multiply, rotate, rotation_of
from coral.contact.mesh import mesh_vertices
from coral.contact.task import Movable, Shape, Task
from coral.contact.world import Body
from coral.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Physical:
    """What cannot be seen: mass (kg) and friction coefficient."""

    mass_kg: float
    friction: float


@dataclass(frozen=True)
class DrawnObject:
    """An object as it stands in one trial.

    Args:
        scale: Shape=(3,) factors on its parts.
        physical: Its true mass and friction.
        pose: Where it stands at first.
    """

    scale: Array
    physical: Physical
    pose: Body


@dataclass(frozen=True)
class Drawn:
    """A task with everything that was left open decided."""

    task: Task
    seed: int
    objects: dict[str, DrawnObject]

    def size(self, name: str) -> Array:
        """Full extents (m) of the object along its own axes, Shape=(3,)."""
        corners = self.corners(name)
        return np.asarray(corners.max(axis=0) - corners.min(axis=0))

    def corners(self, name: str) -> Array:
        """Points, Shape=(n, 3), in the object's frame, whose hull holds it."""
        return corners(self.task.object(name), self.objects[name].scale)

    def point(self, name: str, point: str, body: Body) -> Array:
        """A named point on the object, in the world, Shape=(3,)."""
        local = np.asarray(self.task.object(name).points[point]) * self.objects[name].scale
        return np.asarray(body.position + rotate(body.quaternion, local))

    def lowest_point(self, name: str, body: Body) -> float:
        """Height (m) of the object's lowest point above the table's top."""
        return float(body.position[2] + (self.corners(name) @ rotation_of(body.quaternion).T)[:, 2].min())


def part_size(part: Shape, scale: Array) -> Array:
    """Full size of a part (m) under the object's scale; what is round grows evenly in its round directions."""
    size = np.asarray(part.size) * scale
    if part.shape == "cylinder":
        size[:2] = part.size[0] * np.sqrt(scale[0] * scale[1])
    elif part.shape == "sphere":
        size[:] = part.size[0] * float(np.prod(scale)) ** (1 / 3)
    return size


def corners(item: Movable, scale: Array) -> Array:
    """Points, Shape=(n, 3), in the object's frame, whose hull holds it (round parts by 16 points a rim)."""
    found = []
    for part in item.parts:
        half = part_size(part, scale) / 2
        if part.shape == "mesh":
            local = mesh_vertices(part) * scale
        elif part.shape == "cylinder":
            turns = np.arange(16) * np.pi / 8
            rim = np.stack([half[0] * np.cos(turns), half[0] * np.sin(turns), np.zeros(16)], axis=1)
            local = np.concatenate([rim + [0, 0, half[2]], rim - [0, 0, half[2]]])
        else:
            signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
            local = signs * half
        placed = local @ rotation_of(from_rpy_deg(part.rpy_deg)).T + np.asarray(part.position) * scale
        found.append(placed)
    return np.concatenate(found)


def draw(task: Task, seed: int) -> Drawn:
    """One trial: the same task and seed give the same trial, on every machine.

    Raises:
        InputError: The objects do not fit beside each other in a hundred attempts.
    """
    rng = np.random.default_rng([seed, *task.name.encode()])
    for _ in range(100):
        objects = {item.name: _draw_object(item, rng) for item in task.objects}
        drawn = Drawn(task, seed, objects)
        if _apart(drawn):
            return drawn
    raise InputError(task.name, "objects", "overlapping ranges", "room for all objects beside each other")


def _draw_object(item: Movable, rng: np.random.Generator) -> DrawnObject:
    scale = np.array([rng.uniform(*axis) for axis in item.scale])
    physical = Physical(mass_kg=float(rng.uniform(*item.mass_kg)), friction=float(rng.uniform(*item.friction)))
    x, y, yaw = rng.uniform(*item.x), rng.uniform(*item.y), np.radians(rng.uniform(*item.yaw_deg))
    quaternion = multiply(from_rotvec([0, 0, yaw]), from_rpy_deg(item.rpy_deg))
    z = item.z if item.z is not None else -(corners(item, scale) @ rotation_of(quaternion).T)[:, 2].min()
    return DrawnObject(scale, physical, Body(np.array([x, y, z]), quaternion))


def _apart(drawn: Drawn, gap_m: float = 0.01) -> bool:
    """Whether the objects' upright bounding boxes keep clear of each other."""
    boxes = []
    for name, item in drawn.objects.items():
        placed = drawn.corners(name) @ rotation_of(item.pose.quaternion).T + item.pose.position
        boxes.append((placed.min(axis=0) - gap_m / 2, placed.max(axis=0) + gap_m / 2))
    return not any(
        bool(np.all(a[0] < b[1]) and np.all(b[0] < a[1])) for k, a in enumerate(boxes) for b in boxes[k + 1:]
    )
