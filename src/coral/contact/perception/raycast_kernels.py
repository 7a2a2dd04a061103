"""Exact ray casting of MuJoCo's primitive geoms and of triangle meshes into a z-buffer.

A pixel's ray is eye + t * R (p, q, 1) with p = (u - cx) / fx and q = (v - cy) / fy, so t is the depth along the optical
axis. Each solid is only tested at the pixels inside the projection of its bounding box.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.contact.perception.mesh_kernels import draw_mesh
from coral.contact.perception.solids import BOX, CAPSULE, CYLINDER, MESH, PLANE, SPHERE, Solids

Picture = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]
_NONE = np.inf
NEAR_M, FAR_M = 0.02, 20.0
"""Between these depths an object is drawn that is compared with a picture."""


@njit(cache=True, error_model="numpy")
def render(
    turn: NDArray[np.float64],
    eye: NDArray[np.float64],
    lens: NDArray[np.float64],
    near: float,
    far: float,
    solids: Solids,
    height: int,
    width: int,
) -> Picture:
    """Draw every solid: depth (m), inf without a hit, index of the solid and of its triangle, -1 without one.

    `turn`, Shape=(3, 3), turns the camera's optical frame (x right, y down, z forward) to the frame of the solids, in
    which `eye`, Shape=(3,) m, is the camera; the lens is fx, fy, cx, cy in pixels. Depths from `near` to `far` (m) are
    visible. Each result has the Shape=(height, width).
    """
    depth = np.full((height, width), np.inf)
    solid, face = np.full((height, width), -1, np.int64), np.full((height, width), -1, np.int64)
    o = np.empty(3)
    m = np.empty((3, 3))
    window = np.empty(4, np.int64)
    kind, size = solids.kind, solids.size
    for i in range(kind.size):
        enter_solid(i, turn, eye, solids, o, m)
        _window(kind[i], o, m, size[i], lens, near, far, width, height, window)
        if window[0] >= window[1] or window[2] >= window[3]:
            continue
        if kind[i] == MESH:
            first, count = solids.first_triangle[i], solids.triangle_count[i]
            draw_mesh(i, o, m, lens, near, far, first, count, solids.triangles, depth, solid, face)
        else:
            _primitive(i, kind[i], o, m, size[i], lens, near, far, window, depth, solid, face)
    return depth, solid, face


@njit(cache=True, error_model="numpy")
def enter_solid(
    i: int,
    turn: NDArray[np.float64],
    eye: NDArray[np.float64],
    solids: Solids,
    o: NDArray[np.float64],
    m: NDArray[np.float64],
) -> None:
    """Write place `o`, Shape=(3,) m, and rotation `m`, Shape=(3, 3), of the camera in the frame of one solid."""
    rotation = solids.rotation
    for j in range(3):
        o[j] = 0.0
        for k in range(3):
            o[j] += rotation[i, k, j] * (eye[k] - solids.center[i, k])
            m[j, k] = rotation[i, 0, j] * turn[0, k] + rotation[i, 1, j] * turn[1, k] + rotation[i, 2, j] * turn[2, k]


@njit(cache=True, error_model="numpy")
def draw_object(
    T_camera_object: NDArray[np.float64], solids: Solids, lens: NDArray[np.float64], height: int, width: int
) -> tuple[Picture, NDArray[np.float64], NDArray[np.float64]]:
    """Draw an object, whose solids are in its own frame, alone: the picture, and `turn` and `eye`, as in `render`."""
    turn, eye = np.empty((3, 3)), np.zeros(3)
    for i in range(3):
        for j in range(3):
            turn[i, j] = T_camera_object[j, i]
            eye[i] -= T_camera_object[j, i] * T_camera_object[j, 3]
    return render(turn, eye, lens, NEAR_M, FAR_M, solids, height, width), turn, eye


@njit(cache=True, error_model="numpy", inline="always")
def _extent(kind: int, size: NDArray[np.float64]) -> tuple[float, float, float]:
    """Compute half the extents (m) of the solid's bounding box, in its own frame."""
    if kind == SPHERE:
        return size[0], size[0], size[0]
    if kind == CAPSULE:
        return size[0], size[0], size[0] + size[1]
    if kind == CYLINDER:
        return size[0], size[0], size[1]
    return size[0], size[1], size[2]


@njit(cache=True, error_model="numpy")
def _window(
    kind: int,
    o: NDArray[np.float64],
    m: NDArray[np.float64],
    size: NDArray[np.float64],
    lens: NDArray[np.float64],
    near: float,
    far: float,
    width: int,
    height: int,
    window: NDArray[np.int64],
) -> None:
    """Compute the columns [w0, w1) and rows [w2, w3) that contain the projection of the bounding box."""
    window[0], window[1], window[2], window[3] = 0, width, 0, height
    if kind == PLANE:
        return
    ex, ey, ez = _extent(kind, size)
    low_u, high_u, low_v, high_v = np.inf, -np.inf, np.inf, -np.inf
    nearest, farthest = np.inf, -np.inf
    for corner in range(8):
        x = (ex if corner & 1 else -ex) - o[0]
        y = (ey if corner & 2 else -ey) - o[1]
        z = (ez if corner & 4 else -ez) - o[2]
        a = m[0, 0] * x + m[1, 0] * y + m[2, 0] * z
        b = m[0, 1] * x + m[1, 1] * y + m[2, 1] * z
        c = m[0, 2] * x + m[1, 2] * y + m[2, 2] * z
        nearest, farthest = min(nearest, c), max(farthest, c)
        if c > near:
            low_u, high_u = min(low_u, a / c), max(high_u, a / c)
            low_v, high_v = min(low_v, b / c), max(high_v, b / c)
    if farthest <= near or nearest >= far:
        window[1] = 0
    elif nearest > near:
        window[0] = max(0, int(math.ceil(max(-1.0, lens[2] + lens[0] * low_u))))
        window[1] = min(width, int(math.floor(min(width, lens[2] + lens[0] * high_u))) + 1)
        window[2] = max(0, int(math.ceil(max(-1.0, lens[3] + lens[1] * low_v))))
        window[3] = min(height, int(math.floor(min(height, lens[3] + lens[1] * high_v))) + 1)


@njit(cache=True, error_model="numpy")
def _primitive(
    i: int,
    kind: int,
    o: NDArray[np.float64],
    m: NDArray[np.float64],
    size: NDArray[np.float64],
    lens: NDArray[np.float64],
    near: float,
    far: float,
    window: NDArray[np.int64],
    depth: NDArray[np.float64],
    solid: NDArray[np.int64],
    face: NDArray[np.int64],
) -> None:
    ox, oy, oz = o[0], o[1], o[2]
    sx, sy, sz = size[0], size[1], size[2]
    for v in range(window[2], window[3]):
        q = (v - lens[3]) / lens[1]
        for u in range(window[0], window[1]):
            p = (u - lens[2]) / lens[0]
            dx = m[0, 0] * p + m[0, 1] * q + m[0, 2]
            dy = m[1, 0] * p + m[1, 1] * q + m[1, 2]
            dz = m[2, 0] * p + m[2, 1] * q + m[2, 2]
            if kind == BOX:
                t = _box(ox, oy, oz, dx, dy, dz, sx, sy, sz)
            elif kind == CYLINDER:
                t = _cylinder(ox, oy, oz, dx, dy, dz, sx, sy)
            elif kind == CAPSULE:
                t = _capsule(ox, oy, oz, dx, dy, dz, sx, sy)
            elif kind == PLANE:
                t = _plane(ox, oy, oz, dx, dy, dz, sx, sy)
            else:
                if kind == SPHERE:
                    sy, sz = sx, sx
                t = _ball(ox / sx, oy / sy, oz / sz, dx / sx, dy / sy, dz / sz)
            if near <= t <= far and t < depth[v, u]:
                depth[v, u] = t
                solid[v, u] = i
                face[v, u] = -1


@njit(cache=True, error_model="numpy", inline="always")
def _plane(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, sx: float, sy: float) -> float:
    """Intersect the upper side of z = 0, with half extents sx and sy; 0 means infinite."""
    if oz <= 0.0 or dz >= 0.0:
        return _NONE
    t = -oz / dz
    if (sx > 0.0 and abs(ox + t * dx) > sx) or (sy > 0.0 and abs(oy + t * dy) > sy):
        return _NONE
    return t


@njit(cache=True, error_model="numpy", inline="always")
def _ball(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float) -> float:
    """Intersect the unit ball."""
    a = dx * dx + dy * dy + dz * dz
    b = ox * dx + oy * dy + oz * dz
    c = ox * ox + oy * oy + oz * oz - 1.0
    root = b * b - a * c
    if root < 0.0:
        return _NONE
    return (-b - math.sqrt(root)) / a


@njit(cache=True, error_model="numpy", inline="always")
def _box(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, sx: float, sy: float, sz: float) -> float:
    """Intersect a box by slabs; a ray within the plane of a face misses it."""
    enter, leave = -np.inf, np.inf
    if dx != 0.0:
        a, b = (-sx - ox) / dx, (sx - ox) / dx
        enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    elif abs(ox) > sx:
        return _NONE
    if dy != 0.0:
        a, b = (-sy - oy) / dy, (sy - oy) / dy
        enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    elif abs(oy) > sy:
        return _NONE
    if dz != 0.0:
        a, b = (-sz - oz) / dz, (sz - oz) / dz
        enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    elif abs(oz) > sz:
        return _NONE
    return enter if enter <= leave else _NONE


@njit(cache=True, error_model="numpy", inline="always")
def _cylinder(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, radius: float, half: float) -> float:
    """Intersect an infinite tube, cut by a slab."""
    enter, leave = -np.inf, np.inf
    if dz != 0.0:
        a, b = (-half - oz) / dz, (half - oz) / dz
        enter, leave = min(a, b), max(a, b)
    elif abs(oz) > half:
        return _NONE
    square = dx * dx + dy * dy
    c = ox * ox + oy * oy - radius * radius
    if square > 1e-18:
        b = ox * dx + oy * dy
        root = b * b - square * c
        if root < 0.0:
            return _NONE
        root = math.sqrt(root)
        enter, leave = max(enter, (-b - root) / square), min(leave, (-b + root) / square)
    elif c > 0.0:
        return _NONE
    return enter if enter <= leave else _NONE


@njit(cache=True, error_model="numpy", inline="always")
def _capsule(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, radius: float, half: float) -> float:
    """Intersect a tube without lids, and a ball at each end."""
    best = _NONE
    square = dx * dx + dy * dy
    if square > 1e-18:
        b = ox * dx + oy * dy
        root = b * b - square * (ox * ox + oy * oy - radius * radius)
        if root < 0.0:
            return _NONE
        t = (-b - math.sqrt(root)) / square
        if abs(oz + t * dz) <= half:
            best = t
    best = min(best, _ball(ox / radius, oy / radius, (oz - half) / radius, dx / radius, dy / radius, dz / radius))
    return min(best, _ball(ox / radius, oy / radius, (oz + half) / radius, dx / radius, dy / radius, dz / radius))
