"""Convex pieces of objects: where a straight line leaves a piece, and how deep a point lies in it."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np

from coral.contact.scene.geometry import from_rpy_deg, rotation_of
from coral.contact.scene.mesh import mesh_vertices, placed_vertices
from coral.contact.scene.observation import Array
from coral.contact.scene.shapes import Shape
from coral.contact.scene.trial import Trial, part_scale, part_size


@dataclass(frozen=True)
class Solid:
    """The intersection of half-spaces with, optionally, a ball or an infinite tube along z."""

    planes: Array
    """Shape=(m, 4): outward normal a and offset b of each half-space a.x <= b, in its own frame, m."""
    radius: float | None = None
    """Radius of the ball or tube; None for neither."""
    round_axes: int = 2
    """3 for a ball, 2 for a tube along z."""
    position: Array = field(default_factory=lambda: np.zeros(3))
    """Position in the parent frame, Shape=(3,) m."""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """Rotation from its own frame to the parent frame, Shape=(3, 3)."""

    def leave(self, points: Array, direction: Array) -> tuple[Array, Array]:
        """Compute where straight lines through points, Shape=(n, 3) m, leave the solid; the direction has length 1.

        Returns the distance along the direction from each point, Shape=(n,) m, negative behind it, nan if the line
        misses; and the outward normals there, Shape=(n, 3).
        """
        local, way = (points - self.position) @ self.rotation, direction @ self.rotation
        enter, leave = np.full(len(local), -np.inf), np.full(len(local), np.inf)
        normal = np.zeros((len(local), 3))
        for plane in self.planes:
            gap, rate = plane[3] - local @ plane[:3], float(way @ plane[:3])
            if abs(rate) < 1e-9:
                leave[gap < 0] = -np.inf
            elif rate < 0:
                enter = np.maximum(enter, gap / rate)
            else:
                nearer = gap / rate < leave
                leave[nearer] = (gap / rate)[nearer]
                normal[nearer] = plane[:3]
        if self.radius is not None:
            k = self.round_axes
            a, b = float(way[:k] @ way[:k]), local[:, :k] @ way[:k]
            c = (local[:, :k] ** 2).sum(axis=1) - self.radius**2
            root = b * b - a * c
            if a < 1e-12:
                leave[c > 0] = -np.inf
            else:
                far = (-b + np.sqrt(np.maximum(root, 0.0))) / a
                enter = np.maximum(enter, (-b - np.sqrt(np.maximum(root, 0.0))) / a)
                nearer = far < leave
                leave[nearer] = far[nearer]
                at = local[nearer] + far[nearer, None] * way
                normal[nearer] = 0.0
                normal[np.flatnonzero(nearer), :k] = at[:, :k] / self.radius
                leave[root < 0] = -np.inf
        return np.where(leave >= enter - 1e-9, leave, np.nan), normal @ self.rotation.T

    def depth(self, points: Array) -> Array:
        """Compute the depth (m) of points, Shape=(n,), at most the distance to the surface; negative outside."""
        local = (points - self.position) @ self.rotation
        depth = np.full(len(local), np.inf)
        for plane in self.planes:
            depth = np.minimum(depth, plane[3] - local @ plane[:3])
        if self.radius is not None:
            depth = np.minimum(depth, self.radius - np.linalg.norm(local[:, : self.round_axes], axis=1))
        return depth


def box(size: Array, position: Array | None = None, rotation: Array | None = None) -> Solid:
    """Make a box with these edge lengths (m)."""
    half = np.asarray(size, dtype=float) / 2
    planes = np.concatenate([np.column_stack([sign * np.eye(3), half]) for sign in (1.0, -1.0)])
    at = np.zeros(3) if position is None else np.asarray(position, dtype=float)
    return Solid(planes, position=at, rotation=np.eye(3) if rotation is None else rotation)


def pieces(trial: Trial, name: str) -> tuple[Solid, ...]:
    """Return an object's parts in its own frame, scaled as in the trial; a mesh becomes its convex hull."""
    scale = trial.objects[name].scale
    return tuple(_piece(part, scale) for part in trial.task.object(name).parts)


def _piece(part: Shape, scale: Array) -> Solid:
    position, rotation = np.asarray(part.position) * scale, rotation_of(from_rpy_deg(part.rpy_deg))
    size = part_size(part, scale)
    if part.shape == "mesh":
        return Solid(_hull(mesh_vertices(part) * part_scale(part, scale)), None, 2, position, rotation)
    if part.shape == "box":
        return box(size, position, rotation)
    lids = np.array([[0, 0, 1.0, size[2] / 2], [0, 0, -1.0, size[2] / 2]])
    if part.shape == "cylinder":
        return Solid(lids, float(size[0]) / 2, 2, position, rotation)
    return Solid(np.zeros((0, 4)), float(size[0]) / 2, 3, position, rotation)


def _hull(vertices: Array) -> Array:
    """Return the half-spaces, Shape=(m, 4), of the hull that MuJoCo uses for contact."""
    spec = mujoco.MjSpec()
    # Without faces, MuJoCo uses those of the hull.
    spec.add_mesh(name="hull", uservert=np.ascontiguousarray(vertices, dtype=float).ravel())
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull")
    model = spec.compile()
    corners = placed_vertices(model)
    faces = corners[model.mesh_face]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    real = lengths > 1e-12
    normals = normals[real] / lengths[real, None]
    offsets = (corners @ normals.T).max(axis=0)
    return np.asarray(np.unique(np.round(np.column_stack([normals, offsets]), 7), axis=0))
