"""A lid that stands open on its hinge: push its outer face over and down, keep the hand on it, let go."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.abreast import DOWN, PAD_M
from coral.contact.experts.terms import axis, norm, turned
from coral.contact.scene.task import Task

Array = NDArray[np.float64]
SHARE = 0.7
"""Where the lid is pushed, from its middle (0) to its rim (1)."""
GENTLE_N = 5.0
"""Force that costs nothing. It takes 2 to 7 N to turn the lid there."""


def outer(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Compute the tool position at the lid's outer face, which looks up once it is closed. Shape=(..., 3) m."""
    middle, rim = state[f"{name}_pos"], state[f"{name}_rim_pos"]
    out = axis(state[f"{name}_quat"], "z")
    return np.asarray(middle + SHARE * (rim - middle) + (PAD_M + 0.005 + gap_m) * out)


def closed(state: Context, name: str) -> Array:
    """Compute the cosine of the lid's angle: 1 closed, 0 upright."""
    return axis(state[f"{name}_quat"], "z")[..., 2]


def ajar(state: Context, name: str) -> Array:
    """Compute how far the lid is from shut, for small angles its angle in radians."""
    return np.asarray(np.sqrt(2.0 * np.maximum(1.0 - closed(state, name), 0.0)))


def fsm(task: Task) -> Strategy:
    """Get to the outer face, push it shut, rise."""
    name = task.objects[0].name

    def reach(state: Context) -> Terms:
        return {
            "reach": 12.0 * norm(state.ee_pos - outer(state, name, 0.02)),
            "square": 4.0 * turned(state.ee_quat, DOWN),
            "closed": 20.0 * np.abs(state.gripper_target - 0.02),
            "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
        }

    def push(state: Context) -> Terms:
        return {
            "shut": 4.0 * ajar(state, name),
            "stay at it": 8.0 * norm(state.ee_pos - outer(state, name)),
            "square": 3.0 * turned(state.ee_quat, DOWN),
            "gently": 0.3 * np.maximum(norm(state[f"{name}_hand_force"]) - GENTLE_N, 0.0),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def let_go(state: Context) -> Terms:
        return {
            "away": 8.0 * norm(state.ee_pos - outer(state, name, 0.08)),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "calm": 0.3 * norm(state.ee_vel),
        }

    def arrived(now: Context) -> bool:
        return bool(norm(now.ee_pos - outer(now, name, 0.02))[0, 0] < 0.02)

    def shut(now: Context) -> bool:
        return bool(closed(now, name)[0, 0] > np.cos(np.radians(2.0)))

    def open_again(now: Context) -> bool:
        return bool(closed(now, name)[0, 0] < np.cos(np.radians(20.0)))

    ahead = Guide(lambda now: outer(now, name)[0] + np.array([0.05, 0.0, -0.04]), lambda now: DOWN, 0.02)
    return Strategy(
        "close the lid",
        (
            Stage(
                "reach", reach, (Guide(lambda now: outer(now, name, 0.02)[0], lambda now: DOWN, 0.02),), until=arrived
            ),
            Stage("push", push, (ahead,), until=shut, sigma=0.6),
            Stage("let go", let_go, next=(("reach", open_again),), sigma=0.6),
        ),
    )
