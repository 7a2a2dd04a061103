"""Building blocks of hand-written costs: small functions of batched quantities, pushing with two fingers abreast."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide
from coral.contact.scene.geometry import column_of, from_rotvec, multiply, rotate
from coral.contact.scene.observation import Array

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Palm down, fingers side by side along the world's y: two fingers abreast keep a pushed face aligned."""
PAD_M = 0.010
"""Distance from the tool to the finger's forward face."""
ABREAST_M = 0.03
"""Opening of the fingers while pushing: wide enough to steer, narrower than the box."""


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


def on_box(state: Context, name: str, along: float, up: float) -> Array:
    """Compute a point of the box in the world; `along` and `up` are -1 to 1 over its length and height."""
    half = state[f"{name}_size"] / 2
    local = half * np.array([along, 0.0, up])
    return np.asarray(state[f"{name}_pos"] + rotate(state[f"{name}_quat"], local))


def facing(state: Context, name: str) -> Array:
    """Compute the orientation with the palm down and the fingers abreast of the object's near face, Shape=(4,)."""
    return palm_down(axis(state[f"{name}_quat"], "x")[0, 0])


def palm_down(ahead: Array) -> Array:
    """Compute the hand's orientation, Shape=(4,), palm down, the fingers abreast of a direction, Shape=(3,)."""
    return np.asarray(multiply(from_rotvec([0, 0, float(np.arctan2(ahead[1], ahead[0]))]), DOWN))


def abreast(place: Callable[[Context], Array], turn: Callable[[Context], Array]) -> Guide:
    """Guide two fingers abreast to a place, Shape=(K, H, 3) m, with an orientation, Shape=(4,)."""
    return Guide(lambda now: place(now)[0], turn, ABREAST_M)


def squareness(state: Context, ahead: Array) -> Array:
    """Compute the misalignment with palm down and the fingers abreast of a direction, Shape=(..., 3)."""
    return 1 + axis(state.ee_quat, "z")[..., 2] + 3.0 * np.square(dot(axis(state.ee_quat, "y"), ahead))


def reach_terms(state: Context, name: str, target: Array, misaligned: Array, above_m: float) -> Terms:
    """Compute the cost of coming down from `above_m` behind a face without touching the object.

    The target of the tool has Shape=(..., 3) m, `misaligned`, the fingers' misalignment with the face, Shape=(...).
    """
    off = state.ee_pos - target
    over = np.clip(norm(off[..., :2]) - 0.015, 0, 0.05) / 0.05
    return {
        "reach": 12.0 * norm(off),
        "come from above": 30.0 * over * np.clip(above_m - state.ee_pos[..., 2], 0, 0.1),
        "square": 4.0 * misaligned,
        "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
        "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
    }
