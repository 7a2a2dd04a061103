"""Turning an object about an upright axis, its hinge or its own end: push its far part along a circle, draw back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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


@dataclass(frozen=True)
class Turn:
    """A turn about an upright axis."""

    name: str
    """The object, with its points `tip` and `pivot`."""
    to_deg: float
    """Heading of the arm from `pivot` to `tip` at the end, counter-clockwise from the world's x axis."""
    way: Literal[1, -1]
    """1: counter-clockwise, seen from above."""

    def arm(self, state: Context) -> Array:
        """Compute the vector from pivot to tip along the table, Shape=(..., 3) m."""
        far = state[f"{self.name}_tip_pos"] - state[f"{self.name}_pivot_pos"]
        return np.asarray(far * np.array([1.0, 1.0, 0.0]))

    def angle_left(self, state: Context) -> Array:
        """Compute the angle (rad) that is left, negative beyond it."""
        arm = self.arm(state)
        left = self.way * (np.radians(self.to_deg) - np.arctan2(arm[..., 1], arm[..., 0]))
        return np.asarray((left + np.pi) % (2.0 * np.pi) - np.pi)

    def ahead(self, state: Context) -> Array:
        """Compute the direction in which the tip moves, a unit vector, Shape=(..., 3)."""
        arm = self.arm(state)
        across = np.stack([-arm[..., 1], arm[..., 0], np.zeros_like(arm[..., 0])], axis=-1)
        return np.asarray(self.way * across / np.maximum(norm(arm), 1e-6)[..., None])

    def behind(self, state: Context, gap_m: float = 0.0) -> Array:
        """Compute the tool position for pushing at the face that looks back, Shape=(..., 3) m."""
        half = state[f"{self.name}_size"][..., :2].min(axis=-1) / 2
        return np.asarray(state[f"{self.name}_tip_pos"] - (PAD_M + gap_m + half)[..., None] * self.ahead(state))

    def square(self, state: Context) -> Array:
        """Compute the misalignment with palm down and the fingers abreast of that face."""
        down = 1 + axis(state.ee_quat, "z")[..., 2]
        return np.asarray(down + 3.0 * np.square(dot(axis(state.ee_quat, "y"), self.ahead(state))))


def fsm(task: Task, to_deg: float, way: Literal[1, -1]) -> Strategy:
    """Come down behind the far part of the task's first object, push it round, draw back; see `Turn`."""
    name = task.objects[0].name
    turn = Turn(name, to_deg, way)

    def reach(state: Context) -> Terms:
        above_m = float(state[f"{name}_tip_pos"][..., 2].max()) + 0.08
        return reach_terms(state, name, turn.behind(state, 0.015), turn.square(state), above_m=above_m)

    def push(state: Context) -> Terms:
        return {
            "turn": 6.0 * np.abs(turn.angle_left(state)),
            "behind": 10.0 * norm(state.ee_pos - turn.behind(state)),
            "square": 3.0 * turn.square(state),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "gently": 0.02 * norm(state[f"{name}_hand_force"]),
            "calm": 2.0 * np.clip(norm(state.ee_vel) - PACE_M_S, 0, None),
        }

    def draw_back(state: Context) -> Terms:
        return {
            "away": 8.0 * norm(state.ee_pos - turn.behind(state, 0.05)),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "square": 2.0 * turn.square(state),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def in_place(now: Context) -> bool:
        return bool(norm(now.ee_pos - turn.behind(now, 0.015))[0, 0] < 0.015 and turn.square(now)[0, 0] < 0.15)

    def turned(now: Context) -> bool:
        return bool(turn.angle_left(now)[0, 0] < DONE_RAD)

    def lost(now: Context) -> bool:
        return bool(norm(now.ee_pos - turn.behind(now))[0, 0] > 0.06)

    def guide(gap_m: float, up_m: float = 0.0) -> Guide:
        return Guide(
            lambda now: turn.behind(now, gap_m)[0] + np.array([0.0, 0.0, up_m]),
            lambda now: palm_down(turn.ahead(now)[0, 0]),
            ABREAST_M,
        )

    return Strategy(
        "push round",
        (
            Stage("reach", reach, (guide(0.015), guide(0.015, 0.1)), until=in_place),
            Stage("turn", push, (guide(-0.04),), until=turned, next=(("reach", lost),), sigma=0.6),
            Stage("draw back", draw_back, (guide(0.05),), sigma=0.6),
        ),
    )
