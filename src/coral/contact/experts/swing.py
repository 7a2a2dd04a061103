"""Turning an object about an upright axis, its hinge or its own end: push its far part along a circle, draw back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.abreast import ABREAST_M, PAD_M, palm_down, reach_terms
from coral.contact.experts.terms import axis, dot, norm
from coral.contact.scene.task import Task

Array = NDArray[np.float64]
PACE_M_S = 0.1
"""Speed of the pushed point."""
DONE_RAD = np.radians(4.0)
"""Angle before the wanted one at which the push ends."""


def arm(state: Context, name: str) -> Array:
    """Compute the vector from the object's point `pivot` to its point `push` along the table, Shape=(..., 3) m."""
    return np.asarray((state[f"{name}_push_pos"] - state[f"{name}_pivot_pos"]) * np.array([1.0, 1.0, 0.0]))


def angle_left(state: Context, name: str) -> Array:
    """Compute the angle (rad) that is left to the heading `turn_to_deg` of the arm, negative beyond it."""
    found = arm(state, name)
    heading = np.arctan2(found[..., 1], found[..., 0])
    left = state.turn_way * (np.radians(state.turn_to_deg) - heading)
    return np.asarray((left + np.pi) % (2.0 * np.pi) - np.pi)


def ahead(state: Context, name: str) -> Array:
    """Compute the direction in which the pushed point moves, a unit vector, Shape=(..., 3)."""
    found = arm(state, name)
    across = np.stack([-found[..., 1], found[..., 0], np.zeros_like(found[..., 0])], axis=-1)
    return np.asarray(state.turn_way[..., None] * across / np.maximum(norm(found), 1e-6)[..., None])


def behind(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Compute the tool position for pushing, Shape=(..., 3) m."""
    return np.asarray(state[f"{name}_push_pos"] - (PAD_M + gap_m) * ahead(state, name))


def _square(state: Context, name: str) -> Array:
    return 1 + axis(state.ee_quat, "z")[..., 2] + 3.0 * np.square(dot(axis(state.ee_quat, "y"), ahead(state, name)))


def fsm(task: Task) -> Strategy:
    """Come down behind the far part, push it round, draw back."""
    name = task.objects[0].name

    def reach(state: Context) -> Terms:
        above_m = float(state[f"{name}_push_pos"][..., 2].max()) + 0.08
        return reach_terms(state, name, behind(state, name, 0.015), _square(state, name), above_m=above_m)

    def turn(state: Context) -> Terms:
        return {
            "turn": 6.0 * np.abs(angle_left(state, name)),
            "behind": 10.0 * norm(state.ee_pos - behind(state, name)),
            "square": 3.0 * _square(state, name),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "gently": 0.02 * norm(state[f"{name}_hand_force"]),
            "calm": 2.0 * np.clip(norm(state.ee_vel) - PACE_M_S, 0, None),
        }

    def draw_back(state: Context) -> Terms:
        return {
            "away": 8.0 * norm(state.ee_pos - behind(state, name, 0.05)),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "square": 2.0 * _square(state, name),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def in_place(now: Context) -> bool:
        return bool(norm(now.ee_pos - behind(now, name, 0.015))[0, 0] < 0.015 and _square(now, name)[0, 0] < 0.15)

    def turned(now: Context) -> bool:
        return bool(angle_left(now, name)[0, 0] < DONE_RAD)

    def lost(now: Context) -> bool:
        return bool(norm(now.ee_pos - behind(now, name))[0, 0] > 0.06)

    def facing(now: Context) -> Array:
        return palm_down(ahead(now, name)[0, 0])

    def guide(gap_m: float, up_m: float = 0.0) -> Guide:
        return Guide(lambda now: behind(now, name, gap_m)[0] + np.array([0.0, 0.0, up_m]), facing, ABREAST_M)

    return Strategy(
        "push round",
        (
            Stage("reach", reach, (guide(0.015), guide(0.015, 0.1)), until=in_place),
            Stage("turn", turn, (guide(-0.04),), until=turned, back=("reach", lost), sigma=0.6),
            Stage("draw back", draw_back, (guide(0.05),), sigma=0.6),
        ),
    )
