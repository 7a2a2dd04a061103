"""Pushing with a steady force: come behind the block, push it evenly towards the goal with a soft hand.

The force of a slow push is the block's friction; what spoils it are stops, blows and the stiffness of the hand. So the hand
is soft and the cost asks for an even pace more than for a force: a soft spring that moves evenly transmits evenly.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.context import Context, Terms
from coral.contact.experts.wall import ABREAST_M, PAD_M, on_box
from coral.contact.geometry import from_rotvec, multiply
from coral.contact.strategy import Guide, Stage, Strategy
from coral.contact.task import Task
from coral.contact.vocabulary import axis, dot, level, norm

Array = NDArray[np.float64]
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
PACE_M_S = 0.06
"""20 cm in 3.5 s."""
SOFT_N_M = 200.0
"""6 N at a lag of 3 cm. With 600 N/m a centimetre of sampling noise is the whole force; below 150 N/m the 6 cm that a target
may lead the hand by do not move the heaviest block."""


def to_goal(state: Context, name: str) -> Array:
    """From the block to the goal along the table, Shape=(..., 3) m."""
    return np.asarray((state.goal_pos - state[f"{name}_pos"]) * np.array([1.0, 1.0, 0.0]))


def behind(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Where the tool pushes: the middle of the near face, below half height so that nothing tips."""
    point = on_box(state, name, -1.0, 0.0) - axis(state[f"{name}_quat"], "x") * (PAD_M + gap_m)
    point[..., 2] = 0.022
    return point


def square(state: Context, name: str) -> Array:
    """How far the hand is from palm down with the fingers abreast of the near face."""
    ahead = axis(state[f"{name}_quat"], "x")
    return 1 + axis(state.ee_quat, "z")[..., 2] + 3.0 * np.square(dot(axis(state.ee_quat, "y"), ahead))


def _facing(state: Context, name: str) -> Array:
    ahead = axis(state[f"{name}_quat"], "x")[0, 0]
    return np.asarray(multiply(from_rotvec([0, 0, float(np.arctan2(ahead[1], ahead[0]))]), DOWN))


def _even(state: Context, name: str) -> Array:
    """How far the block's velocity is from the pace towards the goal, falling to rest over the last 2 cm."""
    way = to_goal(state, name)
    left = norm(way)
    wanted = way / np.maximum(left, 1e-6)[..., None] * (PACE_M_S * level(left, 0.0, 0.02))[..., None]
    return norm((state[f"{name}_vel"] - wanted) * np.array([1.0, 1.0, 0.0]))


def single(task: Task) -> Strategy:
    """One cost: be behind the block, bring it to the goal, at the wanted force while touching."""
    name = task.objects[0].name

    def cost(state: Context) -> Terms:
        force = norm(state[f"{name}_hand_force"])
        return {
            "reach": 10.0 * norm(state.ee_pos - behind(state, name)),
            "to the goal": 15.0 * norm(to_goal(state, name)),
            "force": 0.05 * state[f"{name}_hand_contact"] * np.abs(force - state.push_force),
            "square": 2.0 * square(state, name),
            "abreast": 10.0 * np.abs(state.gripper_target - ABREAST_M),
            "calm": 0.5 * norm(state.ee_vel),
        }

    return Strategy("push, single stage", (Stage("push", cost, (
        Guide(lambda now: behind(now, name, 0.01)[0], lambda now: _facing(now, name), ABREAST_M),),
        stiffness_n_m=SOFT_N_M),))


def fsm(task: Task) -> Strategy:
    """Get behind, push evenly."""
    name = task.objects[0].name

    def reach(state: Context) -> Terms:
        off = state.ee_pos - behind(state, name, 0.012)
        over = np.clip(norm(off[..., :2]) - 0.015, 0, 0.05) / 0.05
        return {
            "reach": 12.0 * norm(off),
            "come from above": 30.0 * over * np.clip(0.1 - state.ee_pos[..., 2], 0, 0.1),
            "square": 4.0 * square(state, name),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
        }

    def push(state: Context) -> Terms:
        force = norm(state[f"{name}_hand_force"])
        return {
            "to the goal": 12.0 * norm(to_goal(state, name)),
            "evenly": 12.0 * _even(state, name),
            "behind": 6.0 * norm(state.ee_pos - behind(state, name)),
            "force": 0.06 * np.abs(force - state.push_force),
            "square": 2.0 * square(state, name),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
        }

    def in_place(now: Context) -> bool:
        return bool(norm(now.ee_pos - behind(now, name, 0.012))[0, 0] < 0.015 and square(now, name)[0, 0] < 0.1)

    def lost(now: Context) -> bool:
        return bool(norm(now.ee_pos - behind(now, name))[0, 0] > 0.06)

    place = Guide(lambda now: behind(now, name, 0.012)[0], lambda now: _facing(now, name), ABREAST_M)
    above = Guide(lambda now: behind(now, name, 0.012)[0] + np.array([0, 0, 0.1]), lambda now: _facing(now, name), ABREAST_M)
    return Strategy("push, stages", (
        Stage("reach", reach, (place, above), until=in_place),
        Stage("push", push, stiffness_n_m=SOFT_N_M, back=("reach", lost), sigma=0.5),
    ))
