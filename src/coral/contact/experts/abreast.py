"""Shared parts of strategies that push with two fingers abreast and the palm down."""

from __future__ import annotations

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.experts.terms import axis, norm
from coral.contact.scene.geometry import from_rotvec, multiply, rotate
from coral.contact.scene.observation import Array

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Palm down, fingers side by side along the world's y: two fingers abreast keep a pushed face aligned."""
PAD_M = 0.010
"""Distance from the tool to the finger's forward face."""
ABREAST_M = 0.03
"""Opening of the fingers while pushing: wide enough to steer, narrower than the box."""


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


def reach_terms(state: Context, name: str, target: Array, squareness: Array, above_m: float) -> Terms:
    """Compute the cost of coming down from `above_m` behind a face without touching the object.

    The target of the tool has Shape=(..., 3) m, `squareness`, the fingers' misalignment with the face, Shape=(...).
    """
    off = state.ee_pos - target
    over = np.clip(norm(off[..., :2]) - 0.015, 0, 0.05) / 0.05
    return {
        "reach": 12.0 * norm(off),
        "come from above": 30.0 * over * np.clip(above_m - state.ee_pos[..., 2], 0, 0.1),
        "square": 4.0 * squareness,
        "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
        "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
    }
