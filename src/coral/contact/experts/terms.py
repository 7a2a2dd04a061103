"""Building blocks of hand-written costs: small functions of batched quantities."""

from __future__ import annotations

import numpy as np

from coral.contact.scene.geometry import column_of
from coral.contact.scene.observation import Array


def norm(vector: Array) -> Array:
    """Compute the length of vectors, Shape=(..., 3) to Shape=(...)."""
    return np.asarray(np.sqrt(dot(vector, vector)))


def dot(first: Array, second: Array) -> Array:
    """Compute the scalar product along the last axis."""
    total = first[..., 0] * second[..., 0]
    for k in range(1, first.shape[-1]):  # np.sum along so short an axis takes four times as long
        total = total + first[..., k] * second[..., k]
    return np.asarray(total)


def axis(quaternion: Array, name: str) -> Array:
    """Compute the world direction, Shape=(..., 3), of an axis "x", "y" or "z" of orientations."""
    return column_of(quaternion, "xyz".index(name))


def near(distance: Array, scale: float) -> Array:
    """Compute exp(-(distance / scale)^2): 1 at distance 0, the gate of a bonus."""
    return np.asarray(np.exp(-np.square(distance / scale)))


def turned(first: Array, second: Array) -> Array:
    """Compute the angle (rad) between orientations, 0 to pi."""
    inner = np.abs((first * second).sum(axis=-1))
    return np.asarray(2.0 * np.arccos(np.clip(inner, -1.0, 1.0)))


def level(value: Array, low: float, high: float) -> Array:
    """Compute a ramp: 0 below `low`, 1 above `high`, linear between."""
    return np.clip((value - low) / (high - low), 0.0, 1.0)
