"""The cutting board: push it from behind until its handle is over the edge, go around, pinch the handle, lift."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy, Test
from coral.contact.experts.terms import axis, near, norm, turned
from coral.contact.scene.geometry import quaternion_of
from coral.contact.scene.observation import Array
from coral.contact.scene.task import Task

Place = Callable[[Context], Array]
Way = tuple[str, Test]

DOWN_WIDE = np.array([0.0, np.sqrt(0.5), -np.sqrt(0.5), 0.0])
"""Pointing down, the fingers opening along x: two contact points behind the board."""
POINTING = np.array([0.87, -0.5, 0.0]) / np.hypot(0.87, 0.5)
"""Along the edge and inward: within reach of a Panda on the board's near side with the opening upright."""


UP = np.array([0.0, 0.0, 1.0])
PINCH = quaternion_of(np.column_stack([np.cross(UP, POINTING), UP, POINTING]))
"""Along `POINTING` with the opening's y axis up (the opposite grip is at arm limits)."""


def edge(state: Context) -> Array:
    """Compute how far the handle's middle is beyond the left edge (m)."""
    return np.asarray(state.board_handle_pos[..., 1] - state.table_max[..., 1])


PUSHING_M = 0.014
"""Height of the tool for pushing: the tips just above the table."""


def behind(state: Context, gap_m: float | Array = 0.02) -> Array:
    """Compute the tool position for pushing: behind the rear edge, tips just above the table."""
    point = state.board_rear_pos + np.asarray(gap_m)[..., None] * -axis(state.board_quat, "y")
    point[..., 2] = PUSHING_M
    return np.asarray(point)


def pushing_gap(state: Context) -> Array:
    """Compute the wanted gap (m) to the rear edge: wider for a hand too high to push, up to 3.5 cm.

    Fingertips that have climbed onto the board cannot push it, and a constant gap kept them there: every way down
    begins with a retreat, which cost more than it gained within the horizon (one trial in six with 50 samples).
    """
    return np.asarray(0.008 + 3.0 * np.clip(state.ee_pos[..., 2] - PUSHING_M - 0.003, 0.0, 0.009))


def grip(state: Context) -> Array:
    """Compute the tool position for pinching: short of the handle's middle, so that the palm stays clear of it."""
    return np.asarray(state.board_handle_pos - 0.024 * POINTING)


def push_terms(state: Context, overhang: float) -> Terms:
    """Compute the terms of pushing the board straight out over the edge."""
    short = np.clip(overhang - edge(state), 0.0, None)
    too_far = np.clip(edge(state) - overhang - 0.02, 0.0, None)
    drift = np.abs((state.board_pos - state.board_init_pos)[..., 0])
    return {
        "overhang": 20.0 * short + 60.0 * too_far,
        "stay behind": 8.0 * norm(state.ee_pos - behind(state, pushing_gap(state))),
        "straight": 3.0 * turned(state.board_quat, np.array([1.0, 0, 0, 0])) + 5.0 * drift,
        "point down": 2.0 * turned(state.ee_quat, DOWN_WIDE),
        "fingers wide": 15.0 * np.abs(state.gripper_target - 0.07),
        "gently": 1.0 * norm(state.board_vel) + 0.01 * norm(state.ee_force),
    }


def fsm(task: Task) -> Strategy:
    """Go behind, push, rise, turn, descend beside the handle, reach in, pinch, lift."""
    overhang, height = task.numbers["overhang"], task.numbers["lift_height"]

    def leave(state: Context) -> Array:
        return 5.0 * norm(state.board_vel)

    def calm(state: Context) -> Array:
        return 0.1 * norm(state.ee_vel)

    def approach(state: Context) -> Terms:
        goal = behind(state, 0.03)
        above = np.clip(0.06 - state.ee_pos[..., 2], 0, None) * np.clip(norm(state.ee_pos - goal) - 0.05, 0, 0.1) * 100
        return {
            "reach": 10.0 * norm(state.ee_pos - goal),
            "from above": above,
            "point down": 3.0 * turned(state.ee_quat, DOWN_WIDE),
            "fingers wide": 15.0 * np.abs(state.gripper_target - 0.07),
            "leave alone": leave(state),
        }

    def push(state: Context) -> Terms:
        return push_terms(state, overhang)

    def high(state: Context) -> Array:
        return np.asarray(behind(state, 0.05) + np.array([0.0, 0.0, 0.15]))

    def beside(back_m: float, up_m: float) -> Place:
        return lambda state: np.asarray(grip(state) - back_m * POINTING + np.array([0.0, 0.0, up_m]))

    def pinch(state: Context) -> Terms:
        both = state.board_left_contact * state.board_right_contact
        return {
            "stay": 10.0 * norm(state.ee_pos - grip(state)),
            "turn": 2.0 * turned(state.ee_quat, PINCH),
            "close": 20.0 * (state.gripper_target + 0.04),
            "hold": -1.0 * both,
            "leave alone": leave(state),
        }

    def lift(state: Context) -> Terms:
        lowest = np.minimum(state.board_rear_pos[..., 2], state.board_pos[..., 2])
        return {
            "lift": 10.0 * np.clip(height - lowest, 0, None),
            "carry level": 1.0 * turned(state.board_quat, state.board_init_quat),
            "hold": 20.0 * (state.gripper_target + 0.04) + 6.0 * norm(state.ee_pos - grip(state)),
            "turn": 0.5 * turned(state.ee_quat, PINCH),
            "calm": calm(state),
            "stay near": 2.0 * norm((state.ee_pos - state.board_init_pos)[..., :1]),
        }

    def at(goal: Array, quaternion: Array, now: Context, near_m: float, angle: float) -> bool:
        return bool(norm(now.ee_pos - goal)[0, 0] < near_m and turned(now.ee_quat, quaternion)[0, 0] < angle)

    def to(goal: Place, quaternion: Array | None, opening: float) -> tuple[Guide, ...]:
        turn_to = None if quaternion is None else (lambda now: quaternion)
        return (Guide(lambda now: goal(now)[0], turn_to, opening),)

    def moving(
        name: str, goal: Place, quaternion: Array, near_m: float, angle: float, sigma: float = 1.0, *back: Way
    ) -> Stage:
        """Make a stage that brings the open hand to a place."""

        def pose(state: Context) -> Terms:
            return {
                "reach": 10.0 * norm(state.ee_pos - goal(state)),
                "turn": 2.0 * turned(state.ee_quat, quaternion),
                "opening": 15.0 * np.abs(state.gripper_target - 0.07),
                "leave alone": leave(state),
                "calm": calm(state),
            }

        def arrived(now: Context) -> bool:
            return at(goal(now), quaternion, now, near_m, angle)

        return Stage(name, pose, to(goal, quaternion, 0.07), until=arrived, next=back, sigma=sigma)

    def lost(now: Context) -> bool:
        return bool(norm(now.ee_pos - grip(now))[0, 0] > 0.06)

    def short(now: Context) -> bool:
        return bool(edge(now)[0, 0] < overhang - 0.015)

    return Strategy(
        "board, stages",
        (
            Stage(
                "approach",
                approach,
                to(lambda s: behind(s, 0.03), DOWN_WIDE, 0.07),
                until=lambda now: at(behind(now, 0.03), DOWN_WIDE, now, 0.02, 0.15),
            ),
            Stage(
                "push",
                push,
                to(lambda s: behind(s, 0.0) + np.array([0, 0.1, 0.0]), DOWN_WIDE, 0.07),
                sigma=0.7,
                until=lambda now: bool(edge(now)[0, 0] > overhang - 0.004),
            ),
            moving("rise", high, DOWN_WIDE, 0.04, 0.5),
            moving("turn", beside(0.12, 0.17), PINCH, 0.03, 0.15, 1.0, ("approach", short)),
            moving("descend", beside(0.11, 0.0), PINCH, 0.012, 0.1, 0.6),
            moving("insert", beside(0.0, 0.0), PINCH, 0.012, 0.12, 0.5),
            Stage(
                "pinch",
                pinch,
                to(grip, PINCH, -0.04),
                sigma=0.4,
                next=(("turn", lost),),
                until=lambda now: bool(
                    (now.board_left_contact * now.board_right_contact)[0, 0] > 0 and now.gripper_target[0, 0] < -0.01
                ),
            ),
            Stage(
                "lift",
                lift,
                to(lambda s: s.ee_pos + np.array([0, 0, 0.15]), None, -0.04),
                sigma=0.5,
                next=(("turn", lost),),
            ),
        ),
    )


def single(task: Task) -> Strategy:
    """Use one cost with a soft switch from pushing to picking by the handle's overhang."""
    overhang, height = task.numbers["overhang"], task.numbers["lift_height"]

    def cost(state: Context) -> Terms:
        ready = 1.0 / (1.0 + np.exp(-200.0 * (edge(state) - overhang + 0.012)))
        pushing = {f"push: {name}": (1 - ready) * term for name, term in push_terms(state, overhang).items()}
        distance = norm(state.ee_pos - grip(state))
        close = near(distance, 0.02)
        both = state.board_left_contact * state.board_right_contact
        lowest = np.minimum(state.board_rear_pos[..., 2], state.board_pos[..., 2])
        return {
            **pushing,
            "pick: reach": ready * 10.0 * (distance - 1.0),
            "pick: turn": ready * 2.0 * turned(state.ee_quat, PINCH),
            "pick: open": ready * (1 - close) * 15.0 * (0.08 - state.gripper_target),
            "pick: come from above": ready
            * 30.0
            * np.clip(distance - 0.06, 0, 0.1)
            * np.clip(0.12 - state.ee_pos[..., 2], 0, 0.12)
            / 0.1,
            "pick: do not press": ready * (1 - both) * 0.02 * norm(state.ee_force),
            "pick: close": ready * close * 20.0 * (state.gripper_target - 0.08),
            "pick: lift": -40.0 * ready * both * np.clip(lowest, 0, height),
            "calm": 0.05 * norm(state.ee_vel),
        }

    def aside(now: Context) -> Array:
        """Return points beside the handle, high and low, from which an open hand can reach in."""
        return np.asarray(grip(now)[0] - 0.11 * POINTING + np.array([[0, 0, 0.17], [0, 0, 0.0]]))

    return Strategy(
        "board, single stage",
        (
            Stage(
                "all",
                cost,
                (
                    Guide(lambda now: behind(now, 0.02)[0], lambda now: DOWN_WIDE, 0.07),
                    Guide(lambda now: grip(now)[0], lambda now: PINCH, 0.07),
                    Guide(aside, lambda now: PINCH, 0.07),
                ),
            ),
        ),
    )
