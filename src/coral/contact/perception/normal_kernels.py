"""Unit normals of a picture drawn by `raycast_kernels.render`."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.contact.perception.raycast_kernels import Picture, draw_object, enter_solid
from coral.contact.perception.solids import BOX, CAPSULE, CYLINDER, MESH, PLANE, SPHERE, Solids


@njit(cache=True, error_model="numpy")
def draw_with_normals(
    T_camera_object: NDArray[np.float64], solids: Solids, lens: NDArray[np.float64], height: int, width: int
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Draw an object alone: depth, solid, both Shape=(H, W), and unit normals, Shape=(H, W, 3)."""
    picture, turn, eye = draw_object(T_camera_object, solids, lens, height, width)
    return picture[0], picture[1], normals(turn, eye, lens, solids, picture)


@njit(cache=True, error_model="numpy")
def normals(
    turn: NDArray[np.float64],
    eye: NDArray[np.float64],
    lens: NDArray[np.float64],
    solids: Solids,
    picture: Picture,
) -> NDArray[np.float64]:
    """Compute the unit normals of a picture drawn by `render`, towards the camera, in the camera frame.

    The other arguments are as in `render`. Returns Shape=(H, W, 3), 0 without a surface.
    """
    depth, solid, face = picture
    height, width = depth.shape
    normal = np.zeros((height, width, 3))
    kind, size, triangles = solids.kind, solids.size, solids.triangles
    o, m = np.empty((kind.size, 3)), np.empty((kind.size, 3, 3))  # the camera in every solid's own frame
    for i in range(kind.size):
        enter_solid(i, turn, eye, solids, o[i], m[i])
    h = np.empty(3)
    n = np.empty(3)
    for v in range(height):
        q = (v - lens[3]) / lens[1]
        for u in range(width):
            i = solid[v, u]
            if i < 0:
                continue
            t = depth[v, u]
            p = (u - lens[2]) / lens[0]
            for j in range(3):
                h[j] = o[i, j] + t * (m[i, j, 0] * p + m[i, j, 1] * q + m[i, j, 2])
                n[j] = 0.0
            _normal(kind[i], h, size[i], triangles, face[v, u], n)
            x = m[i, 0, 0] * n[0] + m[i, 1, 0] * n[1] + m[i, 2, 0] * n[2]
            y = m[i, 0, 1] * n[0] + m[i, 1, 1] * n[1] + m[i, 2, 1] * n[2]
            z = m[i, 0, 2] * n[0] + m[i, 1, 2] * n[1] + m[i, 2, 2] * n[2]
            scale = 1.0 / math.sqrt(x * x + y * y + z * z)
            if x * p + y * q + z > 0.0:  # a mesh seen from behind
                scale = -scale
            normal[v, u, 0], normal[v, u, 1], normal[v, u, 2] = scale * x, scale * y, scale * z
    return normal


@njit(cache=True, error_model="numpy")
def _normal(
    kind: int,
    h: NDArray[np.float64],
    size: NDArray[np.float64],
    triangles: NDArray[np.float64],
    face: int,
    n: NDArray[np.float64],
) -> None:
    """Compute the normal of one solid at its surface point `h`, both in its own frame; of any length."""
    if kind == PLANE:
        n[2] = 1.0
    elif kind == BOX:
        best = 0
        for k in range(1, 3):
            if abs(h[k]) - size[k] > abs(h[best]) - size[best]:
                best = k
        n[best] = 1.0 if h[best] > 0.0 else -1.0
    elif kind == CYLINDER:
        if abs(h[2]) - size[1] > math.sqrt(h[0] * h[0] + h[1] * h[1]) - size[0]:
            n[2] = 1.0 if h[2] > 0.0 else -1.0
        else:
            n[0], n[1] = h[0], h[1]
    elif kind == CAPSULE:
        n[0], n[1] = h[0], h[1]
        n[2] = h[2] - min(max(h[2], -size[1]), size[1])
    elif kind == MESH:
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            n[k] = (triangles[face, 1, a] - triangles[face, 0, a]) * (triangles[face, 2, b] - triangles[face, 0, b]) - (
                triangles[face, 1, b] - triangles[face, 0, b]
            ) * (triangles[face, 2, a] - triangles[face, 0, a])
    else:
        for k in range(3):
            radius = size[0] if kind == SPHERE else size[k]
            n[k] = h[k] / (radius * radius)
