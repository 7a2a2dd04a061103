"""A drawer: grasp its handle from above and pull it open; push its front shut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.abreast import DOWN, PAD_M
from coral.contact.experts.terms import near, norm, turned
from coral.contact.scene.relative_conditions import Opened
from coral.contact.scene.task import Task

Array = NDArray[np.float64]
OVER_M = 0.06
"""Height above the handle from which the open hand comes down."""
PACE_M_S = 0.1
"""Speed at which a drawer is moved."""


def opened_band(task: Task) -> tuple[float, float]:
    """Return the extent (m) that the task asks of its first object."""
    [band] = [one.between_m for one in task.success.conditions if isinstance(one, Opened) and one.between_m is not None]
    return band


def handle(state: Context, name: str) -> Array:
    """Compute the tool position at the handle, Shape=(..., 3) m."""
    return state[f"{name}_handle_pos"]


def pulled(state: Context, name: str) -> Array:
    """Compute how far the drawer has come towards the robot since the start (m)."""
    return np.asarray((state[f"{name}_init_pos"] - state[f"{name}_pos"])[..., 0])


def _square(state: Context) -> Array:
    return turned(state.ee_quat, DOWN)


def opening(task: Task) -> Strategy:
    """Come down over the handle, close the fingers, pull."""
    name = task.objects[0].name
    wanted = opened_band(task)[0] + 0.02

    def reach(state: Context) -> Terms:
        off = state.ee_pos - handle(state, name)
        aside = np.clip(norm(off[..., :2]) - 0.006, 0, 0.05) / 0.05
        return {
            "reach": 12.0 * norm(off),
            "come from above": 40.0 * aside * np.clip(OVER_M - off[..., 2], 0, 0.1),
            "square": 4.0 * _square(state),
            "open": 20.0 * (0.08 - state.gripper_target),
            "leave alone": 0.1 * norm(state[f"{name}_hand_force"]),
        }

    def grip(state: Context) -> Terms:
        return {
            "stay": 15.0 * norm(state.ee_pos - handle(state, name)),
            "square": 2.0 * _square(state),
            "close": 20.0 * state.gripper_target,
        }

    def pull(state: Context) -> Terms:
        return {
            "open": 20.0 * np.abs(wanted - pulled(state, name)),
            "hold": 20.0 * state.gripper_target + 15.0 * norm(state.ee_pos - handle(state, name)),
            "square": 2.0 * _square(state),
            "calm": 2.0 * np.clip(norm(state[f"{name}_vel"]) - PACE_M_S, 0, None),
        }

    def above(now: Context) -> Array:
        return np.asarray(handle(now, name)[0] + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, OVER_M]]))

    def off(now: Context) -> float:
        return float(norm(now.ee_pos - handle(now, name))[0, 0])

    def held(now: Context) -> bool:
        return bool((now[f"{name}_left_contact"] * now[f"{name}_right_contact"])[0, 0] > 0)

    lost = ("reach", lambda now: off(now) > 0.04)
    return Strategy(
        "open the drawer",
        (
            Stage("reach", reach, (Guide(above, lambda now: DOWN, 0.08),), until=lambda now: off(now) < 0.012),
            Stage("grip", grip, until=held, next=(lost,), sigma=0.5),
            Stage(
                "pull", pull, (Guide(lambda now: now.ee_pos[0] - [0.1, 0, 0], opening_m=0.0),), next=(lost,), sigma=0.6
            ),
        ),
    )


def closing(task: Task) -> Strategy:
    """Come down before the handle, push it in, draw back."""
    name = task.objects[0].name

    def before(state: Context, gap_m: float) -> Array:
        return np.asarray(handle(state, name) - np.array([PAD_M + gap_m, 0.0, 0.0]))

    def reach(state: Context) -> Terms:
        off = state.ee_pos - before(state, 0.015)
        aside = np.clip(norm(off[..., :2]) - 0.015, 0, 0.05) / 0.05
        return {
            "reach": 12.0 * norm(off),
            "come from above": 30.0 * aside * np.clip(0.05 - off[..., 2], 0, 0.1),
            "square": 4.0 * _square(state),
            "closed": 20.0 * np.abs(state.gripper_target),
            "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
        }

    def push(state: Context) -> Terms:
        left = state.shut_pos[..., 0] - state[f"{name}_pos"][..., 0]
        return {
            "shut": 20.0 * np.clip(left, 0, None),
            "behind": 10.0 * norm(state.ee_pos - before(state, 0.0)),
            "square": 3.0 * _square(state),
            "gently": 0.02 * norm(state[f"{name}_hand_force"]),
            "calm": 2.0 * np.clip(norm(state[f"{name}_vel"]) - PACE_M_S, 0, None),
        }

    def draw_back(state: Context) -> Terms:
        return {
            "away": 8.0 * norm(state.ee_pos - before(state, 0.05)),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "calm": 0.3 * norm(state.ee_vel),
        }

    def shut(now: Context) -> bool:
        return bool(now.shut_pos[0, 0, 0] - now[f"{name}_pos"][0, 0, 0] < 0.004)

    return Strategy(
        "close the drawer",
        (
            Stage(
                "reach",
                reach,
                (Guide(lambda now: before(now, 0.015)[0], lambda now: DOWN, 0.0),),
                until=lambda now: bool(near(norm(now.ee_pos - before(now, 0.015)), 0.02)[0, 0] > 0.5),
            ),
            Stage(
                "push", push, (Guide(lambda now: before(now, -0.05)[0], lambda now: DOWN, 0.0),), until=shut, sigma=0.6
            ),
            Stage("draw back", draw_back, sigma=0.6),
        ),
    )
