"""The model of an object that a tracker uses: solids, surface points, size and symmetry."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import solids as kinds
from coral.contact.perception.solids import Solids, from_mujoco
from coral.contact.perception.surface_kernels import distance
from coral.contact.perception.symmetry import Symmetry, of_kind, of_shape
from coral.contact.scene.geometry import inverse_transform, pose_matrix, rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial
from coral.errors import InputError

_POINTS = 1500
"""Number of surface points: 5 mm apart on the board, so that ADD-S between equal poses stays below 3 mm."""
_SIDES = 48
"""Sides of the prism that replaces a round part when triangles are needed; its flats are 0.2 % of the radius deep."""


@dataclass(frozen=True)
class ObjectModel:
    """A rigid object in its own frame."""

    solids: Solids
    triangles: Array
    """Surface, Shape=(m, 3, 3) m; round parts as prisms."""
    points: Array
    """Points spread evenly over the surface, Shape=(n, 3) m."""
    symmetry: Symmetry
    """Rotations that map the object onto itself."""
    diameter: float
    """Largest distance (m) between two of its points."""
    pivot: Array
    """Centre of its bounding box, Shape=(3,) m."""


def from_body(model: mujoco.MjModel, body: str, symmetry: Symmetry | None = None) -> ObjectModel:
    """Model an object from the drawn geoms of one body of a MuJoCo scene, in the frame of that body.

    Its symmetry is computed if none is given.

    Raises:
        InputError: There is no such body, or none of its geoms is drawn.
    """
    index = mujoco.mj_name2id(model, int(mujoco.mjtObj.mjOBJ_BODY), body)
    if index < 0:
        raise InputError("scene", "body", body, "the name of a body in the scene")
    trial = (model.geom_bodyid == index) & (model.geom_group <= 2) & (model.geom_rgba[:, 3] > 0)
    geoms = np.flatnonzero(trial).astype(np.int64)
    if not len(geoms):
        raise InputError("scene", f"body {body}", "no drawn geoms", "at least one geom in groups 0 to 2")
    placed = from_mujoco(model, geoms)._replace(
        center=model.geom_pos[geoms].astype(float), rotation=rotation_of(model.geom_quat[geoms])
    )
    return _model(placed, symmetry)


def from_trial(model: mujoco.MjModel, trial: Trial, name: str) -> ObjectModel:
    """Model one object of a trial, with its exact shape.

    The symmetry is the declared one, or that of the shape if it is larger: depth shows only the shape.
    """
    found = from_body(model, name)
    kind = trial.task.object(name).symmetry
    declared = of_kind(kind, trial.size(name), found.pivot)
    if kind == "none" or len(declared.members(12)) <= len(found.symmetry.members(12)):
        return found
    return from_body(model, name, declared)


def _model(solids: Solids, symmetry: Symmetry | None) -> ObjectModel:
    parts = [_surface(solids, i) for i in range(len(solids.kind))]
    triangles = np.concatenate(parts)
    points = _sample(solids, parts)
    corners = triangles.reshape(-1, 3)
    if symmetry is None:
        few = points[:: max(1, len(points) // 300)]
        # A prism lies inside its round part: deviations up to twice its sagitta are no asymmetry.
        slack = 2 * (1 - math.cos(math.pi / _SIDES)) * float(np.abs(corners).max())
        symmetry = of_shape(few, lambda p: distance(np.ascontiguousarray(p), triangles), 0.001 + slack)
    low, high = corners.min(0), corners.max(0)
    sparse = corners[:: max(1, len(corners) // 2000)]
    diameter = max(float(np.linalg.norm(sparse - c, axis=1).max()) for c in sparse)
    return ObjectModel(solids, triangles, points, symmetry, diameter, (low + high) / 2)


def _surface(solids: Solids, i: int) -> Array:
    """Triangulate the surface of one solid, outward, in the object's frame. Shape=(m, 3, 3)."""
    kind, size = int(solids.kind[i]), solids.size[i]
    if kind == kinds.MESH:
        corners = solids.triangles[solids.first_triangle[i] :][: solids.triangle_count[i]]
    elif kind == kinds.BOX:
        corners = _grid_surface(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float), size)
    elif kind == kinds.CYLINDER:
        turn = 2 * math.pi * np.arange(_SIDES) / _SIDES
        corners = _grid_surface(np.stack([np.cos(turn), np.sin(turn)], 1), np.array([size[0], size[0], size[1]]))
    else:
        corners = _round_surface(kind, size)
    return np.asarray(corners @ solids.rotation[i].T + solids.center[i])


def _grid_surface(outline: Array, half: Array) -> Array:
    """Triangulate a prism over a counter-clockwise outline, Shape=(n, 2)."""
    n = len(outline)
    low, high = (np.column_stack([outline, np.full(n, side)]) * half for side in (-1.0, 1.0))
    faces = []
    for k in range(n):
        j = (k + 1) % n
        faces += [[low[k], low[j], high[j]], [low[k], high[j], high[k]]]
    for k in range(1, n - 1):
        faces += [[high[0], high[k], high[k + 1]], [low[0], low[k + 1], low[k]]]
    return np.array(faces)


def _round_surface(kind: int, size: Array) -> Array:
    """Triangulate a sphere, an ellipsoid or a capsule, ring by ring."""
    scale = size if kind == kinds.ELLIPSOID else np.full(3, size[0])
    rise = size[1] if kind == kinds.CAPSULE else 0.0
    latitudes = np.linspace(-math.pi / 2, math.pi / 2, _SIDES // 2 + 1)
    if rise:  # a capsule has its equator twice
        latitudes = np.sort(np.append(latitudes, 0.0))
    turn = 2 * math.pi * np.arange(_SIDES) / _SIDES
    lift = np.where(np.arange(len(latitudes)) * 2 < len(latitudes), -rise, rise) if rise else np.zeros(len(latitudes))
    ring = np.stack(
        [
            np.outer(np.cos(latitudes), np.cos(turn)) * scale[0],
            np.outer(np.cos(latitudes), np.sin(turn)) * scale[1],
            np.repeat((np.sin(latitudes) * scale[2] + lift)[:, None], _SIDES, 1),
        ],
        -1,
    )
    a, b = ring[:-1], ring[1:]
    c, d = np.roll(a, -1, 1), np.roll(b, -1, 1)
    faces = np.concatenate([np.stack([a, c, d], 2).reshape(-1, 3, 3), np.stack([a, d, b], 2).reshape(-1, 3, 3)])
    area = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)
    return np.asarray(faces[area > 1e-14])


def _sample(solids: Solids, parts: list[Array]) -> Array:
    """Sample points evenly by area (R2 sequence), without those inside another primitive part."""
    owner = np.repeat(np.arange(len(parts)), [len(p) for p in parts])
    triangles = np.concatenate(parts)
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    share = np.cumsum(area)
    k = np.arange(_POINTS) + 0.5
    chosen = np.searchsorted(share, k / _POINTS * share[-1]).clip(0, len(triangles) - 1)
    a, b = (k * 0.7548776662466927) % 1.0, (k * 0.5698402909980532) % 1.0
    over = a + b > 1.0
    a, b = np.where(over, 1 - a, a)[:, None], np.where(over, 1 - b, b)[:, None]
    t = triangles[chosen]
    points = t[:, 0] + a * (t[:, 1] - t[:, 0]) + b * (t[:, 2] - t[:, 0])
    outside = np.ones(len(points), bool)
    for i in range(len(parts)):
        outside &= ~(_inside(solids, i, points) & (owner[chosen] != i))
    return np.asarray(points[outside])


def _inside(solids: Solids, i: int, points: Array) -> NDArray[np.bool_]:
    """Check which points lie inside one solid; never inside a mesh, which need not be closed."""
    back = inverse_transform(pose_matrix(solids.rotation[i], solids.center[i]))
    p = points @ back[:3, :3].T + back[:3, 3]
    kind, size = int(solids.kind[i]), solids.size[i]
    if kind == kinds.MESH:
        return np.zeros(len(points), bool)
    if kind == kinds.BOX:
        return np.asarray((np.abs(p) < size - 1e-9).all(1))
    radius = np.hypot(p[:, 0], p[:, 1])
    if kind == kinds.CYLINDER:
        return np.asarray((radius < size[0] - 1e-9) & (np.abs(p[:, 2]) < size[1] - 1e-9))
    if kind == kinds.CAPSULE:
        over = (np.abs(p[:, 2]) - size[1]).clip(0.0)
        return np.asarray(np.hypot(radius, over) < size[0] - 1e-9)
    scale = size if kind == kinds.ELLIPSOID else np.full(3, size[0])
    return np.asarray(((p / scale) ** 2).sum(1) < 1.0 - 1e-9)
