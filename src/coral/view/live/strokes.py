"""Polylines, bundles, rings and crosses as line segments of the live page."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Segments = NDArray[np.float32]
NONE: Segments = np.zeros((0, 2, 3), np.float32)


def path(points: NDArray[np.float64], z: float) -> Segments:
    """Make a polyline through `points`, Shape=(N, 2), at height `z` (m). Shape=(N - 1, 2, 3)."""
    return bundle(np.asarray(points, np.float64).reshape(1, -1, 2), z)


def bundle(paths: NDArray[np.float64], z: float) -> Segments:
    """Make polylines of equal length, Shape=(K, N, 2), at height `z` (m). Shape=(K (N - 1), 2, 3)."""
    k, n = paths.shape[:2]
    if n < 2:
        return NONE
    segments = np.full((k, n - 1, 2, 3), z, np.float32)
    segments[:, :, 0, :2] = paths[:, :-1]
    segments[:, :, 1, :2] = paths[:, 1:]
    return segments.reshape(-1, 2, 3)


def ring(x: float, y: float, radius: float, z: float, sides: int = 32) -> Segments:
    """Make a circle. Shape=(sides, 2, 3)."""
    return path(oval(np.array([x, y]), np.array([radius, radius]), 0.0, sides), z)


def crosshair(x: float, y: float, radius: float, z: float) -> Segments:
    """Make a ring with four arms, the symbol of goals on maps."""
    inner, outer = 0.6 * radius, 1.5 * radius
    arms = np.array(
        [
            [(x + inner * i, y + inner * j), (x + outer * i, y + outer * j)]
            for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]
    )
    return np.concatenate([ring(x, y, radius, z), bundle(arms, z)])


def arrow(start: NDArray[np.float64], end: NDArray[np.float64], z: float) -> Segments:
    """Make a line with a head. `start`, `end`: Shape=(2,), metres."""
    along = np.asarray(end, np.float64) - start
    across = np.array([-along[1], along[0]])
    barbs = [np.array([end, end - 0.3 * along + side * 0.18 * across]) for side in (1.0, -1.0)]
    return bundle(np.array([[start, end], *barbs]), z)


def oval(center: NDArray[np.float64], half: NDArray[np.float64], yaw: float, sides: int = 24) -> NDArray[np.float64]:
    """Make the outline of an ellipse with half-axes `half` (m), turned by `yaw` (rad). Shape=(sides + 1, 2)."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    return _rotate(center, np.stack([half[0] * np.cos(angle), half[1] * np.sin(angle)], 1), yaw)


def rectangle(center: NDArray[np.float64], half: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """Make the outline of a rectangle with half edges `half` (m), turned by `yaw` (rad). Shape=(5, 2)."""
    return _rotate(center, np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * half, yaw)


def _rotate(center: NDArray[np.float64], points: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    c, s = np.cos(yaw), np.sin(yaw)
    turned: NDArray[np.float64] = center + points @ np.array([[c, s], [-s, c]])
    return turned


def joined(polylines: Sequence[NDArray[np.float64]]) -> Segments:
    """Make segments of polylines in space, Shape=(N, 3) each. Shape=(S, 2, 3)."""
    parts = [np.stack([line[:-1], line[1:]], axis=1) for line in polylines if len(line) > 1]
    return np.concatenate(parts).astype(np.float32) if parts else NONE
