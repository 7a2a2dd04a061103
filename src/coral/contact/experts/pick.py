"""Picking: come from above, close around the object, lift."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.terms import axis, near, norm
from coral.contact.scene.geometry import conjugate, multiply, rotate, rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.state_conditions import Grasped, Lifted, Still, Upright
from coral.contact.scene.task import Task

FINGER_OUT_M = 0.05
"""Distance from the tool to the middle of a finger of the open hand."""
ENOUGH_M = 0.02
"""Clearance beside a finger; more has no benefit."""


def picks(task: Task) -> bool:
    """Check whether the task's only goal is to lift its first object and to hold it as it stood."""
    return all(
        isinstance(condition, Lifted | Grasped | Upright | Still) and condition.object == task.objects[0].name
        for condition in task.success.conditions
    ) and any(isinstance(condition, Lifted | Grasped) for condition in task.success.conditions)


def across(state: Context, name: str) -> Array:
    """Compute the misalignment (0: none) of opening with the object's narrowest side, and of the palm with down."""
    opening, palm = axis(state.ee_quat, "y"), axis(state.ee_quat, "z")
    sides = rotation_of(state[f"{name}_quat"])
    square = 1 - np.abs(np.einsum("...i,...ij->...j", opening, sides))
    width = state[f"{name}_size"] + 1.0 * (np.abs(sides[..., 2, :]) > 0.7)
    wider = width - width.min(axis=-1, keepdims=True)
    return np.asarray(np.min(square + 10.0 * wider, axis=-1) + (1 + palm[..., 2]))


def middle(state: Context, name: str) -> Array:
    """Return the object's centre: its point "middle" where a task names one, else its origin."""
    named = f"{name}_middle_pos"
    return state[named] if named in state else state[f"{name}_pos"]


def grasp_point(state: Context, name: str) -> Array:
    """Compute the tool position of the grasp: the object's centre, or 2 cm below the top of a tall object."""
    point = middle(state, name).copy()
    point[..., 2] = np.maximum(point[..., 2], point[..., 2] + state[f"{name}_size"][..., 2] / 2 - 0.025)
    return point


def over(name: str, height_m: float = 0.0, others: Sequence[str] = ()) -> Guide:
    """Make a guide to the grasp, opening across the object's nearer side, fingers open."""

    def turn(state: Context) -> Array:
        return grasp_quaternion(state, name, others)

    return Guide(lambda state: grasp_point(state, name)[0] + [0, 0, height_m], turn, 0.08)


def grasp_quaternion(state: Context, name: str, others: Sequence[str] = ()) -> Array:
    """Compute the orientation of a grasp from above, Shape=(4,): with room for the fingers, near the present one.

    A square object can be grasped along both sides; beside a carton only one of them leaves room for a finger.
    """
    tool, body = state.ee_quat[0, 0], state[f"{name}_quat"][0, 0]
    size = state[f"{name}_size"][0, 0]
    lying = [k for k in range(3) if abs(rotation_of(body)[2, k]) < 0.7]
    least = min(size[k] for k in lying)
    sides = [rotation_of(body)[:, k] for k in lying if size[k] < least + 0.003]
    point = grasp_point(state, name)[0, 0]
    # Open along a narrow side: the hand's y axis, which is the world's -y turned by the heading.
    turns = [
        (multiply([np.cos(a / 2), 0, 0, np.sin(a / 2)], [0, 1.0, 0, 0]), clearance)
        for side in sides
        for clearance in (room(state, others, point + FINGER_OUT_M * np.array([side, -side])),)
        for a in (np.arctan2(side[1], side[0]) + np.pi / 2, np.arctan2(side[1], side[0]) - np.pi / 2)
    ]
    return np.asarray(max(turns, key=lambda one: (one[1], abs(float(np.dot(one[0], tool)))))[0])


def room(state: Context, others: Sequence[str], points: Array) -> float:
    """Compute the least clearance (m) of fingers at some points, Shape=(n, 3), beside other objects.

    At most `ENOUGH_M`; full above an object.
    """
    if not others:
        return ENOUGH_M
    size, turn = (np.stack([state[f"{other}_{what}"][0, 0] for other in others]) for what in ("size", "quat"))
    place = np.stack([middle(state, other)[0, 0] for other in others])
    local = rotate(conjugate(turn)[:, None], points - place[:, None])
    beside = norm(np.clip(np.abs(local) - size[:, None] / 2, 0.0, None))
    return min(float(beside.min()), ENOUGH_M)


def single(task: Task) -> Strategy:
    """Use one cost: reach, close near the object, and lift once it is held."""
    name = task.objects[0].name
    height = task.numbers.get("lift_height", 0.12)

    def cost(state: Context) -> Terms:
        distance = norm(state.ee_pos - grasp_point(state, name))
        close = near(distance, 0.02)
        held = state[f"{name}_left_contact"] * state[f"{name}_right_contact"]
        lifted = np.clip(state[f"{name}_pos"][..., 2] - state[f"{name}_init_pos"][..., 2], 0, height)
        return {
            "reach": 12.0 * distance,
            "square": 2.0 * across(state, name),
            "open": 10.0 * (1 - close) * (0.08 - state.gripper_target),
            "close": -2.0 * close * (1 - state.gripper_target / 0.08),
            "hold": -1.5 * held,
            "lift": -60.0 * held * lifted,
            "calm": 0.05 * norm(state.ee_vel),
        }

    return Strategy("pick, single stage", (Stage("pick", cost, (over(name), over(name, 0.08))),))


def fsm(task: Task) -> Strategy:
    """Reach, close, lift; return to reaching if the object is lost.

    A task with the number `hover_height` has objects that a finger on its way would push over, or that leave the open
    hand little room: the hand comes to rest so far (m) above the grasp before it goes down. The arm lags behind its
    plan, and a finger that lands on the rim of a can stays there.
    """
    name, *others = (item.name for item in task.objects)
    height = task.numbers.get("lift_height", 0.12)
    hover_m = task.numbers.get("hover_height", 0.0)

    def off(state: Context) -> Array:
        return norm(state.ee_pos - grasp_point(state, name))

    def reach(state: Context) -> Terms:
        aside = norm((state.ee_pos - grasp_point(state, name))[..., :2])
        ready = np.maximum(np.clip(aside - 0.008, 0, 0.05) / 0.05, np.clip(across(state, name) - 0.02, 0, 0.2) / 0.2)
        above = middle(state, name)[..., 2] + state[f"{name}_size"][..., 2] / 2 + 0.03
        return {
            "reach": 12.0 * off(state),
            "come from above": 40.0 * ready * np.clip(above - state.ee_pos[..., 2], 0, 0.1),
            "square": 4.0 * across(state, name),
            "open": 20.0 * (0.08 - state.gripper_target),
            "leave alone": 0.1 * norm(state[f"{name}_hand_force"]),
        }

    def above_it(state: Context) -> Array:
        return norm(state.ee_pos - grasp_point(state, name) - np.array([0.0, 0.0, hover_m]))

    def align(state: Context) -> Terms:
        return {
            "reach": 12.0 * above_it(state),
            "square": 4.0 * across(state, name),
            "open": 20.0 * (0.08 - state.gripper_target),
            "leave alone": 0.1 * norm(state[f"{name}_hand_force"]),
            "calm": 0.1 * norm(state.ee_vel),
        }

    def aligned(now: Context) -> bool:
        aside = norm((now.ee_pos - grasp_point(now, name))[..., :2])
        return bool(aside[0, 0] < 0.003 and above_it(now)[0, 0] < 0.02 and across(now, name)[0, 0] < 0.03)

    def close(state: Context) -> Terms:
        return {
            "stay": 15.0 * off(state),
            "square": 2.0 * across(state, name),
            "close": 20.0 * state.gripper_target,
            "hold": -1.0 * state[f"{name}_left_contact"] * state[f"{name}_right_contact"],
        }

    def lift(state: Context) -> Terms:
        goal = state[f"{name}_init_pos"] + np.array([0, 0, height + 0.02])
        return {
            "lift": 10.0 * np.abs(state[f"{name}_pos"] - goal)[..., 2],
            "stay over": 2.0 * norm((state[f"{name}_pos"] - goal)[..., :2]),
            "hold": 20.0 * state.gripper_target + 6.0 * off(state),
            "upright": 1.0 * (1 + axis(state.ee_quat, "z")[..., 2]),
            "calm": 0.1 * norm(state.ee_vel),
        }

    def reached(now: Context) -> bool:
        return bool(off(now)[0, 0] < 0.012 and across(now, name)[0, 0] < 0.05)

    def held(now: Context) -> bool:
        both = now[f"{name}_left_contact"] * now[f"{name}_right_contact"]
        return bool(both[0, 0] > 0)

    def lost(now: Context) -> bool:
        return bool(off(now)[0, 0] > 0.04)

    up = Guide(lambda now: now.ee_pos[0] + [0.0, 0.0, height], opening_m=0.0)
    first = (Stage("align", align, (over(name, hover_m, others),), until=aligned),) if hover_m else ()
    again = "align" if first else "reach"
    return Strategy(
        "pick, stages",
        (
            *first,
            Stage("reach", reach, (over(name, 0.08, others), over(name, 0.0, others)), until=reached),
            Stage("close", close, until=held, next=((again, lost),), sigma=0.5),
            Stage("lift", lift, (up,), next=((again, lost),), sigma=0.7),
        ),
    )
