"""Two fingers abreast behind a face: what the strategies that push with the palm down share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms
from coral.contact.experts.terms import axis, norm
from coral.contact.scene.geometry import from_rotvec, multiply, rotate

Array = NDArray[np.float64]
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Palm down, fingers side by side along the world's y: two fingers abreast hold a pushed face square."""
PAD_M = 0.010
"""From the tool to the finger's forward face."""
ABREAST_M = 0.03
"""Opening at which the fingers push: wide enough to steer, narrower than the box."""


def on_box(state: Context, name: str, along: float, up: float) -> Array:
    """A point of the box in the world; -1 to 1 over its own length and height."""
    half = state[f"{name}_size"] / 2
    local = half * np.array([along, 0.0, up])
    return np.asarray(state[f"{name}_pos"] + rotate(state[f"{name}_quat"], local))


def facing(state: Context, name: str) -> Array:
    """Orientation of the hand with the palm down and the fingers abreast of the object's near face, Shape=(4,)."""
    return palm_down(axis(state[f"{name}_quat"], "x")[0, 0])


def palm_down(ahead: Array) -> Array:
    """Orientation of the hand, Shape=(4,), with the palm down and the fingers abreast of a direction, Shape=(3,)."""
    return np.asarray(multiply(from_rotvec([0, 0, float(np.arctan2(ahead[1], ahead[0]))]), DOWN))


def reach_terms(state: Context, name: str, target: Array, squareness: Array, above_m: float) -> Terms:
    """Cost of coming down behind a face without touching the object.

    Args:
        state: The batch.
        name: The object.
        target: Shape=(..., 3) m, where the tool is to be.
        squareness: Shape=(...), how far the hand is from abreast of the face.
        above_m: Height from which the hand comes down.
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
