"""Flipping against a wall: push the box to it, lift the near end while pressing, stand it up, release.

The wall is in front: the box is pushed along +x, and its end that faces the hand rises. Seen from the side, the near
face's lower edge slides up the finger's face while the far face slides into the corner of wall and table. The finger's
friction lifts; the wall reacts at the height of the box, so a flat box is easy and a cube is not.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.experts.terms import (
    ABREAST_M,
    DOWN,
    PAD_M,
    abreast,
    axis,
    facing,
    near,
    norm,
    on_box,
    reach_terms,
    squareness,
)
from coral.contact.scene.observation import Array
from coral.contact.scene.task import Task


def wall_face(state: Context) -> Array:
    """Compute the x coordinate of the wall's near face."""
    return np.asarray(state.wall_pos[..., 0] - state.wall_size[..., 0] / 2)


def raised(state: Context, name: str) -> Array:
    """Compute the sine of the angle to which the near end is raised: 0 flat, 1 standing."""
    return -axis(state[f"{name}_quat"], "x")[..., 2]


def behind(state: Context, name: str, gap_m: float = 0.0, height_m: float = 0.016) -> Array:
    """Compute the tool position for pushing a lying box: at its near face, just above the table."""
    ahead = axis(state[f"{name}_quat"], "x")
    point = on_box(state, name, -1.0, 0.0) - ahead * (PAD_M + gap_m)
    point[..., 2] = height_m
    return point


def under(state: Context, name: str) -> Array:
    """Compute the tool position for lifting: near face's lower edge on the finger's face, a little above the tip."""
    return np.asarray(on_box(state, name, -1.0, -1.0) + np.array([-PAD_M, 0.0, 0.004]))


def square(state: Context, name: str | None = None) -> Array:
    """Compute the misalignment with palm down and the fingers abreast of the box's near face (or of the wall)."""
    ahead = np.array([1.0, 0.0, 0.0]) if name is None else axis(state[f"{name}_quat"], "x")
    return squareness(state, ahead)


def single(task: Task) -> Strategy:
    """Use one cost: get behind the box, push it to the wall, and raise its near end there."""
    name = task.objects[0].name

    def cost(state: Context) -> Terms:
        gap = np.clip(wall_face(state) - on_box(state, name, 1.0, 0.0)[..., 0], 0, None)
        at_wall = near(gap, 0.03)
        up = np.clip(raised(state, name), 0, 1)
        return {
            "reach": 10.0 * norm(state.ee_pos - under(state, name)) * (1 - near(1 - up, 0.1)),
            "to the wall": 15.0 * gap * (1 - up),
            "raise": -4.0 * at_wall * up,
            "square": 1.0 * square(state),
            "abreast": 10.0 * np.abs(state.gripper_target - ABREAST_M),
            "gently": 0.01 * norm(state[f"{name}_hand_force"]),
            "let go": 0.5 * near(1 - up, 0.05) * state[f"{name}_hand_contact"],
        }

    guide = abreast(lambda now: behind(now, name), partial(facing, name=name))
    return Strategy("flip with wall, single stage", (Stage("flip", cost, (guide,)),))


def fsm(task: Task) -> Strategy:
    """Get behind, push to the wall, raise, release."""
    name = task.objects[0].name

    def reach(state: Context) -> Terms:
        return reach_terms(state, name, behind(state, name, 0.012), square(state, name), above_m=0.09)

    def gap(state: Context) -> Array:
        return np.clip(wall_face(state) - on_box(state, name, 1.0, 0.0)[..., 0], 0, None)

    def push(state: Context) -> Terms:
        return {
            "behind": 10.0 * norm(state.ee_pos - behind(state, name)),
            "to the wall": 20.0 * gap(state),
            "straight": 3.0 * np.square(axis(state[f"{name}_quat"], "x")[..., 1]),
            "square": 3.0 * square(state, name),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "gently": 0.02 * norm(state[f"{name}_hand_force"]),
            "calm": 0.5 * norm(state[f"{name}_vel"]),
        }

    def lift(state: Context) -> Terms:
        force = state[f"{name}_hand_force"]
        return {
            "raise": 6.0 * (1 - raised(state, name)),
            "stay under": 12.0 * norm(state.ee_pos - under(state, name)),
            "at the wall": 10.0 * np.clip(wall_face(state) - on_box(state, name, 1.0, 1.0)[..., 0], 0, None),
            "square": 2.0 * square(state),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "press": 0.05 * np.abs(force[..., 0] - 6.0),
            # Without this the finger jams between box and wall with 40 N when the box is half way up.
            "gently": 0.1 * np.clip(norm(state.ee_force) - 12.0, 0, None),
            "calm": 0.2 * norm(state[f"{name}_vel"]),
        }

    def let_go(state: Context) -> Terms:
        away = on_box(state, name, -1.0, -1.0) + np.array([-0.06, 0.0, 0.02])
        return {
            "away": 10.0 * norm(state.ee_pos - away),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "leave standing": 8.0 * (1 - raised(state, name)),
            "gently": 0.05 * norm(state.ee_force),
            "square": 2.0 * square(state),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def in_place(now: Context) -> bool:
        return bool(norm(now.ee_pos - behind(now, name, 0.012))[0, 0] < 0.015 and square(now, name)[0, 0] < 0.1)

    def at_wall(now: Context) -> bool:
        return bool(gap(now)[0, 0] < 0.008 and abs(axis(now[f"{name}_quat"], "x")[0, 0, 1]) < 0.1)

    def lost(now: Context) -> bool:
        off = now.ee_pos - behind(now, name)
        return bool(raised(now, name)[0, 0] < 0.2 and norm(off)[0, 0] > 0.06)

    def standing(now: Context) -> bool:
        return bool(raised(now, name)[0, 0] > 0.985)

    def fallen(now: Context) -> bool:
        return bool(raised(now, name)[0, 0] < 0.5)

    turn = partial(facing, name=name)
    place = abreast(lambda now: behind(now, name, 0.012), turn)
    above = abreast(lambda now: behind(now, name, 0.012, 0.1), turn)
    onward = abreast(lambda now: behind(now, name, -0.02), turn)
    press = abreast(lambda now: under(now, name) + np.array([0.005, 0.0, 0.03]), lambda now: DOWN)
    return Strategy(
        "flip with wall, stages",
        (
            Stage("reach", reach, (place, above), until=in_place),
            Stage("push", push, (onward,), until=at_wall, next=(("reach", lost),), sigma=0.6),
            Stage("lift", lift, (press,), until=standing, next=(("reach", lost),), sigma=0.6),
            Stage("let go", let_go, next=(("reach", fallen),), sigma=0.6),
        ),
    )
