"""Exact ray casting of ellipsoids, boxes and upright cylinders into a z-buffer.

A pixel's ray is origin + t * d with d = R (p, q, 1), p = (u - cx) / fx, q = (v - cy) / fy, so t is the depth along the
optical axis. In the frame in which a solid is the unit ball, cube or cylinder, origin and direction become o and
d' = A + C q + B p. Along an image row every test is then a polynomial in p. The inner loops have no branches, so the
compiler can vectorise them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.world.scene import SceneSolids

WATER, SEABED = -2, -1
"""Values of `ids` where no solid is seen."""
_ELLIPSOID, _BOX = 0, 1


class ZBuffer(NamedTuple):
    """What is seen so far of H by W pixels, and their rays."""

    near: float
    """Smallest depth (m) at which a surface is seen."""
    p: NDArray[np.float64]
    """(u - cx) / fx of every column. Shape=(W,)."""
    q: NDArray[np.float64]
    """(v - cy) / fy of every row. Shape=(H,)."""
    lens: tuple[float, float, float, float]
    """fx, fy, cx, cy (px)."""
    depth: NDArray[np.float32]
    """Depth (m) of what is seen. Shape=(H, W)."""
    ids: NDArray[np.int32]
    """Index of the solid that is seen, or `WATER` or `SEABED`. Shape=(H, W)."""


@njit(cache=True, error_model="numpy")
def render(
    pose: NDArray[np.float64],
    seabed_z: float,
    near: float,
    range_m: float,
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    reach: NDArray[np.float32],
    solids: SceneSolids,
    label: NDArray[np.uint8],
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    ids: NDArray[np.int32],
) -> None:
    """Render the seabed and every solid.

    Args:
        pose: Shape=(4, 4), camera optical frame to world.
        seabed_z: Height of the sea floor (m).
        near: Smallest depth (m) at which a surface is seen.
        range_m: Solids that lie wholly beyond this range (m) are skipped.
        p: Shape=(W,), (u - cx) / fx of every column.
        q: Shape=(H,), (v - cy) / fy of every row.
        reach: Shape=(H, W), depth (m) at which each pixel's ray has covered `range_m`.
        solids: N of them.
        label: Shape=(N,), class of every solid.
        depth: Shape=(H, W), written: depth (m), inf where nothing is seen.
        labels: Shape=(H, W), written: `Label` of every pixel.
        ids: Shape=(H, W), written: index of the solid, -1 elsewhere.
    """
    kind, center, half, rotation, radius = solids
    width, height = p.size, q.size
    turn = np.ascontiguousarray(pose[:3, :3])
    eye = pose[:3, 3].copy()
    fx, fy = 1.0 / (p[1] - p[0]), 1.0 / (q[1] - q[0])
    seen = ZBuffer(near, p, q, (fx, fy, -p[0] * fx, -q[0] * fy), depth, ids)
    _seabed(turn, seabed_z - eye[2], reach, seen)
    # A ball is out of view if it lies wholly beyond one of the four side planes. Their normals are unit vectors here.
    left, right, top, bottom = p[0], p[width - 1], q[0], q[height - 1]
    n_left, n_right = 1.0 / math.sqrt(1.0 + left * left), 1.0 / math.sqrt(1.0 + right * right)
    n_top, n_bottom = 1.0 / math.sqrt(1.0 + top * top), 1.0 / math.sqrt(1.0 + bottom * bottom)
    unit = np.empty((3, 3))
    origin = np.empty(3)
    window = np.empty(4, np.int64)
    for i in range(kind.size):
        dx, dy, dz = center[i, 0] - eye[0], center[i, 1] - eye[1], center[i, 2] - eye[2]
        r = radius[i]
        if not dx * dx + dy * dy + dz * dz <= (range_m + r) ** 2:  # "not <=" skips NaN too
            continue
        z = turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz
        if not z + r >= near:
            continue
        x = turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz
        if (x - left * z) * n_left < -r or (x - right * z) * n_right > r:
            continue
        y = turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz
        if (y - top * z) * n_top < -r or (y - bottom * z) * n_bottom > r:
            continue
        for j in range(3):
            a, b, c = rotation[i, 0, j], rotation[i, 1, j], rotation[i, 2, j]
            scale = 1.0 / half[i, j]
            origin[j] = -(a * dx + b * dy + c * dz) * scale
            for k in range(3):
                unit[j, k] = (a * turn[0, k] + b * turn[1, k] + c * turn[2, k]) * scale
        if kind[i] == _ELLIPSOID:
            _ellipsoid(i, origin, unit, seen)
        else:
            _window(x, y, z, unit, half[i], seen, window)
            if kind[i] == _BOX:
                _box(i, origin, unit, window, seen)
            else:
                _cylinder(i, origin, unit, window, seen)
    for v in range(height):
        for u in range(width):
            i = ids[v, u]
            if i >= 0:
                labels[v, u] = label[i]
            elif i == SEABED:
                labels[v, u] = 3
            else:
                labels[v, u] = 0
                depth[v, u] = np.inf
                ids[v, u] = -1


@njit(cache=True, error_model="numpy")
def _seabed(turn: NDArray[np.float64], drop: float, reach: NDArray[np.float32], seen: ZBuffer) -> None:
    """Start the z-buffer with the plane at height `drop` (m, negative below the camera), seen only from above."""
    near, p, q, _, depth, ids = seen
    for v in range(q.size):
        e = turn[2, 1] * q[v] + turn[2, 2]
        slope = turn[2, 0]
        for u in range(p.size):
            d = e + slope * p[u]
            t = drop / d
            far = reach[v, u]
            hit = (d < 0.0) & (t >= near) & (t < far)
            depth[v, u] = t if hit else far
            ids[v, u] = SEABED if hit else WATER


@njit(cache=True, error_model="numpy")
def _ellipsoid(i: int, o: NDArray[np.float64], m: NDArray[np.float64], seen: ZBuffer) -> None:
    """Intersect the unit ball |o + t d'|^2 = 1. Its silhouette |d'|^2 = |o x d'|^2, a conic, bounds the pixels."""
    near, p, q, (fx, fy, cx, cy), depth, ids = seen
    width, height = p.size, q.size
    o0, o1, o2 = o[0], o[1], o[2]
    b0, b1, b2 = m[0, 0], m[1, 0], m[2, 0]
    c0, c1, c2 = m[0, 1], m[1, 1], m[2, 1]
    a0, a1, a2 = m[0, 2], m[1, 2], m[2, 2]
    h0, h1, h2 = o1 * b2 - o2 * b1, o2 * b0 - o0 * b2, o0 * b1 - o1 * b0
    k0, k1, k2 = o1 * c2 - o2 * c1, o2 * c0 - o0 * c2, o0 * c1 - o1 * c0
    l0, l1, l2 = o1 * a2 - o2 * a1, o2 * a0 - o0 * a2, o0 * a1 - o1 * a0
    bb = b0 * b0 + b1 * b1 + b2 * b2
    ob = o0 * b0 + o1 * b1 + o2 * b2
    # alpha p^2 + 2 beta p + gamma >= 0 inside the silhouette, beta and gamma polynomials in q.
    alpha = bb - h0 * h0 - h1 * h1 - h2 * h2
    beta0 = b0 * a0 + b1 * a1 + b2 * a2 - h0 * l0 - h1 * l1 - h2 * l2
    beta1 = b0 * c0 + b1 * c1 + b2 * c2 - h0 * k0 - h1 * k1 - h2 * k2
    gamma0 = a0 * a0 + a1 * a1 + a2 * a2 - l0 * l0 - l1 * l1 - l2 * l2
    gamma1 = a0 * c0 + a1 * c1 + a2 * c2 - l0 * k0 - l1 * k1 - l2 * k2
    gamma2 = c0 * c0 + c1 * c1 + c2 * c2 - k0 * k0 - k1 * k1 - k2 * k2
    first, last = 0, height - 1
    if alpha < 0.0:
        d2, d1, d0 = beta1 * beta1 - alpha * gamma2, beta0 * beta1 - alpha * gamma1, beta0 * beta0 - alpha * gamma0
        if d2 < 0.0:
            square = d1 * d1 - d2 * d0
            if square < 0.0:
                return
            root = math.sqrt(square)
            first = int(min(max(math.floor(cy + fy * (-d1 + root) / d2), 0.0), float(height)))
            last = int(max(min(math.ceil(cy + fy * (-d1 - root) / d2), height - 1.0), -1.0))
    for v in range(first, last + 1):
        qv = q[v]
        beta = beta0 + beta1 * qv
        gamma = gamma0 + (2.0 * gamma1 + gamma2 * qv) * qv
        start, stop = 0, width
        if alpha < 0.0:
            square = beta * beta - alpha * gamma
            if square < 0.0:
                continue
            root = math.sqrt(square)
            start = int(min(max(math.floor(cx + fx * (-beta + root) / alpha), 0.0), float(width)))
            stop = int(max(min(math.ceil(cx + fx * (-beta - root) / alpha), width - 1.0), -1.0)) + 1
        e0, e1, e2 = a0 + c0 * qv, a1 + c1 * qv, a2 + c2 * qv
        ee = e0 * e0 + e1 * e1 + e2 * e2
        be = b0 * e0 + b1 * e1 + b2 * e2
        oe = o0 * e0 + o1 * e1 + o2 * e2
        for u in range(start, stop):
            pu = p[u]
            square = gamma + (2.0 * beta + alpha * pu) * pu
            root = math.sqrt(square if square > 0.0 else 0.0)
            inverse = 1.0 / (ee + (2.0 * be + bb * pu) * pu)
            middle = -(oe + ob * pu)
            t = (middle - root) * inverse
            t = t if t >= near else (middle + root) * inverse
            t32 = np.float32(t)
            old = depth[v, u]
            hit = (square >= 0.0) & (t >= near) & (t32 < old)
            depth[v, u] = t32 if hit else old
            ids[v, u] = i if hit else ids[v, u]


@njit(cache=True, error_model="numpy")
def _window(
    x: float,
    y: float,
    z: float,
    m: NDArray[np.float64],
    half: NDArray[np.float64],
    seen: ZBuffer,
    window: NDArray[np.int64],
) -> None:
    """Return the pixels [u0, u1) x [v0, v1) that an oriented box can cover in front of the near plane."""
    near, (fx, fy, cx, cy), (height, width) = seen.near, seen.lens, seen.depth.shape
    corner = np.empty((8, 3))
    for k in range(8):
        # m is diag(1 / half) R_object_camera: half^2 times its rows are the box's half edges in the camera frame.
        s0 = half[0] * half[0] * (1.0 if k & 1 else -1.0)
        s1 = half[1] * half[1] * (1.0 if k & 2 else -1.0)
        s2 = half[2] * half[2] * (1.0 if k & 4 else -1.0)
        corner[k, 0] = x + s0 * m[0, 0] + s1 * m[1, 0] + s2 * m[2, 0]
        corner[k, 1] = y + s0 * m[0, 1] + s1 * m[1, 1] + s2 * m[2, 1]
        corner[k, 2] = z + s0 * m[0, 2] + s1 * m[1, 2] + s2 * m[2, 2]
    u0, u1, v0, v1 = np.inf, -np.inf, np.inf, -np.inf
    for k in range(8):
        zk = corner[k, 2]
        if zk >= near:
            u, v = corner[k, 0] / zk, corner[k, 1] / zk
            u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
        for bit in (1, 2, 4):
            n = k | bit
            if n != k and (zk < near) != (corner[n, 2] < near):
                s = (near - zk) / (corner[n, 2] - zk)
                u = (corner[k, 0] + s * (corner[n, 0] - corner[k, 0])) / near
                v = (corner[k, 1] + s * (corner[n, 1] - corner[k, 1])) / near
                u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
    window[0] = int(min(max(math.floor(cx + fx * u0), 0.0), float(width)))
    window[1] = int(max(min(math.ceil(cx + fx * u1), width - 1.0), -1.0)) + 1
    window[2] = int(min(max(math.floor(cy + fy * v0), 0.0), float(height)))
    window[3] = int(max(min(math.ceil(cy + fy * v1), height - 1.0), -1.0)) + 1


@njit(cache=True, error_model="numpy")
def _box(i: int, o: NDArray[np.float64], m: NDArray[np.float64], window: NDArray[np.int64], seen: ZBuffer) -> None:
    """Intersect the cube |x|, |y|, |z| <= 1: the ray is inside from the last slab entered to the first slab left."""
    near, p, q, _, depth, ids = seen
    o0, o1, o2 = o[0], o[1], o[2]
    b0, b1, b2 = m[0, 0], m[1, 0], m[2, 0]
    for v in range(window[2], window[3]):
        e0, e1, e2 = m[0, 2] + m[0, 1] * q[v], m[1, 2] + m[1, 1] * q[v], m[2, 2] + m[2, 1] * q[v]
        for u in range(window[0], window[1]):
            w0, w1, w2 = 1.0 / (e0 + b0 * p[u]), 1.0 / (e1 + b1 * p[u]), 1.0 / (e2 + b2 * p[u])
            # Distance along the ray to a slab's middle plane, and half the length inside the slab.
            n0, n1, n2 = -o0 * w0, -o1 * w1, -o2 * w2
            f0, f1, f2 = abs(w0), abs(w1), abs(w2)
            enter, other = n0 - f0, n1 - f1
            enter = enter if enter > other else other
            other = n2 - f2
            enter = enter if enter > other else other
            leave, other = n0 + f0, n1 + f1
            leave = leave if leave < other else other
            other = n2 + f2
            leave = leave if leave < other else other
            t = enter if enter >= near else leave
            t32 = np.float32(t)
            old = depth[v, u]
            hit = (enter <= leave) & (t >= near) & (t32 < old)
            depth[v, u] = t32 if hit else old
            ids[v, u] = i if hit else ids[v, u]


@njit(cache=True, error_model="numpy")
def _cylinder(i: int, o: NDArray[np.float64], m: NDArray[np.float64], window: NDArray[np.int64], seen: ZBuffer) -> None:
    """Intersect the cylinder x^2 + y^2 <= 1, |z| <= 1: the side as a quadratic, the caps as a slab."""
    near, p, q, _, depth, ids = seen
    o0, o1, o2 = o[0], o[1], o[2]
    b0, b1, b2 = m[0, 0], m[1, 0], m[2, 0]
    outside = o0 * o0 + o1 * o1 - 1.0
    for v in range(window[2], window[3]):
        e0, e1, e2 = m[0, 2] + m[0, 1] * q[v], m[1, 2] + m[1, 1] * q[v], m[2, 2] + m[2, 1] * q[v]
        for u in range(window[0], window[1]):
            d0, d1 = e0 + b0 * p[u], e1 + b1 * p[u]
            a = d0 * d0 + d1 * d1
            a = a if a > 1e-12 else 1e-12  # a ray along the axis
            b = o0 * d0 + o1 * d1
            square = b * b - a * outside
            root = math.sqrt(square if square > 0.0 else 0.0)
            inverse = 1.0 / a
            enter, leave = (-b - root) * inverse, (-b + root) * inverse
            w = 1.0 / (e2 + b2 * p[u])
            n, f = -o2 * w, abs(w)
            enter = enter if enter > n - f else n - f
            leave = leave if leave < n + f else n + f
            t = enter if enter >= near else leave
            t32 = np.float32(t)
            old = depth[v, u]
            hit = (square >= 0.0) & (enter <= leave) & (t >= near) & (t32 < old)
            depth[v, u] = t32 if hit else old
            ids[v, u] = i if hit else ids[v, u]
