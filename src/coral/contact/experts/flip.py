"""Flipping a standing box: push near its top so that it tips about its far lower edge, and let it lie.

Past its balance the box falls by itself; the hand only chooses the height of the push. High up, the lower edge's
friction holds and the box tips; too low, it slides.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.experts.terms import ABREAST_M, PAD_M, abreast, axis, dot, near, norm, on_box, palm_down, squareness
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.task import Task

HIGH = 0.75
"""Height of the push, -1 at the bottom to 1 at the top: as high as possible with the fingertip below the edge."""


def ahead(state: Context, name: str) -> Array:
    """Compute the unit vector across the broad side of the box in its initial pose: the direction of the fall."""
    return rotation_of(state[f"{name}_init_quat"])[..., 0]


def tipped(state: Context, name: str) -> Array:
    """Compute the sine of the box's tilt towards that direction: 0 standing, 1 lying."""
    return dot(axis(state[f"{name}_quat"], "z"), ahead(state, name))


def behind(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Compute the tool position for pushing: behind the broad side, near its top."""
    return on_box(state, name, -1.0, HIGH) - ahead(state, name) * (PAD_M + gap_m)


def facing(state: Context, name: str) -> Array:
    """Compute the orientation for pushing: palm down, fingers abreast of the broad side, Shape=(4,)."""
    return palm_down(ahead(state, name)[0, 0])


def single(task: Task) -> Strategy:
    """Use one cost: stay behind the top of the box until it leans, and move away once it lies."""
    name = task.objects[0].name

    def cost(state: Context) -> Terms:
        lean = np.clip(tipped(state, name), 0, 1)
        lying = near(1 - lean, 0.15)
        return {
            "reach": 10.0 * norm(state.ee_pos - behind(state, name)) * (1 - lying),
            "tip": -4.0 * lean,
            "square": 1.0 * squareness(state, ahead(state, name)),
            "abreast": 10.0 * np.abs(state.gripper_target - ABREAST_M),
            "do not slide": 3.0 * norm((on_box(state, name, 1.0, -1.0) - state[f"{name}_init_pos"])[..., :2]),
            "gently": 0.02 * norm(state[f"{name}_hand_force"]),
            "let go": 1.0 * lying * state[f"{name}_hand_contact"],
        }

    guide = abreast(lambda now: behind(now, name, 0.01), partial(facing, name=name))
    return Strategy("flip, single stage", (Stage("flip", cost, (guide,)),))


def fsm(task: Task) -> Strategy:
    """Get behind the top, tip, retract."""
    name = task.objects[0].name

    def reach(state: Context) -> Terms:
        return {
            "reach": 12.0 * norm(state.ee_pos - behind(state, name, 0.015)),
            # On the way around the box: a push from above or from a side would topple it in another direction.
            "leave alone": 1.0 * state[f"{name}_hand_contact"] + 0.2 * norm(state[f"{name}_hand_force"]),
            "square": 4.0 * squareness(state, ahead(state, name)),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
        }

    def tip(state: Context) -> Terms:
        return {
            "behind": 10.0 * norm(state.ee_pos - behind(state, name)),
            "tip": 5.0 * (1 - tipped(state, name)),
            "square": 3.0 * squareness(state, ahead(state, name)),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "gently": 0.05 * norm(state[f"{name}_hand_force"]),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def draw_back(state: Context) -> Terms:
        away = state[f"{name}_init_pos"] - 0.08 * ahead(state, name)
        away[..., 2] = 0.14
        return {
            "away": 8.0 * norm(state.ee_pos - away),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "square": 2.0 * squareness(state, ahead(state, name)),
            "calm": 0.3 * norm(state.ee_vel),
        }

    def in_place(now: Context) -> bool:
        return bool(
            norm(now.ee_pos - behind(now, name, 0.015))[0, 0] < 0.015 and squareness(now, ahead(now, name))[0, 0] < 0.1
        )

    def strayed(now: Context) -> bool:
        return bool(tipped(now, name)[0, 0] < 0.15 and norm(now.ee_pos - behind(now, name))[0, 0] > 0.06)

    def falling(now: Context) -> bool:
        return bool(tipped(now, name)[0, 0] > 0.75)

    def standing(now: Context) -> bool:
        return bool(tipped(now, name)[0, 0] < 0.3)

    turn = partial(facing, name=name)
    place = abreast(lambda now: behind(now, name, 0.015), turn)
    above = abreast(lambda now: behind(now, name, 0.015) + np.array([0, 0, 0.06]), turn)
    beyond = abreast(lambda now: behind(now, name, -0.05), turn)
    return Strategy(
        "flip, stages",
        (
            Stage("reach", reach, (place, above), until=in_place),
            Stage("tip", tip, (beyond,), until=falling, next=(("reach", strayed),), sigma=0.6),
            Stage("draw back", draw_back, next=(("reach", standing),), sigma=0.6),
        ),
    )
