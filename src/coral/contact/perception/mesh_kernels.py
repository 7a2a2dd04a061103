"""Rasterisation of triangles into a z-buffer."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, error_model="numpy")
def draw_mesh(
    i: int,
    o: NDArray[np.float64],
    m: NDArray[np.float64],
    lens: NDArray[np.float64],
    near: float,
    far: float,
    first: int,
    count: int,
    triangles: NDArray[np.float64],
    depth: NDArray[np.float64],
    solid: NDArray[np.int64],
    face: NDArray[np.int64],
) -> None:
    """Draw a mesh in homogeneous form (Olano & Greer 1997): a ray hits where all edge products have the same sign.

    The test needs no projection of corners, so triangles that reach behind the camera are exact. Writes `i` into
    `solid`, and changes `depth` and `face`, where the mesh is nearer. `o`, Shape=(3,) m, is the camera in the mesh's
    frame, `m` turns its optical frame to the mesh's. The mesh has `count` triangles from `first` on, of Shape=(M, 3,
    3). All other arguments are as in `raycast_kernels.render`.
    """
    height, width = depth.shape
    c = np.empty((3, 3))
    edge = np.empty((3, 3))
    for k in range(first, first + count):
        ahead = 0
        low_u, high_u, low_v, high_v = np.inf, -np.inf, np.inf, -np.inf
        for a in range(3):
            x, y, z = triangles[k, a, 0] - o[0], triangles[k, a, 1] - o[1], triangles[k, a, 2] - o[2]
            for b in range(3):
                c[a, b] = m[0, b] * x + m[1, b] * y + m[2, b] * z
            if c[a, 2] > near:
                ahead += 1
                low_u, high_u = min(low_u, c[a, 0] / c[a, 2]), max(high_u, c[a, 0] / c[a, 2])
                low_v, high_v = min(low_v, c[a, 1] / c[a, 2]), max(high_v, c[a, 1] / c[a, 2])
        if ahead == 0:
            continue
        u0, u1, v0, v1 = 0, width, 0, height
        if ahead == 3:
            u0 = max(0, int(math.ceil(max(-1.0, lens[2] + lens[0] * low_u))))
            u1 = min(width, int(math.floor(min(width, lens[2] + lens[0] * high_u))) + 1)
            v0 = max(0, int(math.ceil(max(-1.0, lens[3] + lens[1] * low_v))))
            v1 = min(height, int(math.floor(min(height, lens[3] + lens[1] * high_v))) + 1)
            if u0 >= u1 or v0 >= v1:
                continue
        for a in range(3):
            b = (a + 1) % 3
            edge[a, 0] = c[a, 1] * c[b, 2] - c[a, 2] * c[b, 1]
            edge[a, 1] = c[a, 2] * c[b, 0] - c[a, 0] * c[b, 2]
            edge[a, 2] = c[a, 0] * c[b, 1] - c[a, 1] * c[b, 0]
        nx, ny, nz = (
            edge[0, 0] + edge[1, 0] + edge[2, 0],
            edge[0, 1] + edge[1, 1] + edge[2, 1],
            edge[0, 2] + edge[1, 2] + edge[2, 2],
        )
        volume = c[0, 0] * edge[1, 0] + c[0, 1] * edge[1, 1] + c[0, 2] * edge[1, 2]
        for v in range(v0, v1):
            q = (v - lens[3]) / lens[1]
            for u in range(u0, u1):
                p = (u - lens[2]) / lens[0]
                e0 = edge[0, 0] * p + edge[0, 1] * q + edge[0, 2]
                e1 = edge[1, 0] * p + edge[1, 1] * q + edge[1, 2]
                e2 = edge[2, 0] * p + edge[2, 1] * q + edge[2, 2]
                if (e0 < 0.0 or e1 < 0.0 or e2 < 0.0) and (e0 > 0.0 or e1 > 0.0 or e2 > 0.0):
                    continue
                slope = nx * p + ny * q + nz
                if slope == 0.0:
                    continue
                t = volume / slope
                if near <= t <= far and t < depth[v, u]:
                    depth[v, u] = t
                    solid[v, u] = i
                    face[v, u] = k
