"""Pushing with a steady force: approach from behind, push the block evenly towards the goal with a soft hand.

The force of a slow push is the block's friction; stops, impacts and the hand's stiffness disturb it. So the hand is so
soft that even at the longest lead of its target it cannot push harder than the block may be pushed; and its target
moves straight ahead at constant speed with free orientation. A soft spring that moves evenly transmits the force
evenly.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.terms import ABREAST_M, PAD_M, abreast, axis, dot, facing, level, near, norm, reach_terms
from coral.contact.scene.observation import Array
from coral.contact.scene.task import Task

PACE_M_S = 0.035
"""20 cm in 6 s; the spring's damping adds 2 N at this speed."""
SOFT_N_M = 150.0
"""The 6 cm that a target may lead the hand by make 9 N: enough for the heaviest block, and hardly more than is wanted.

A sliding block chatters under the fingers, and at each beat they climb its face a little (2 to 3 cm on the way to the
goal, measured, whatever the height, tilt, opening and speed). A target that stays below then drags the block down,
which increases its friction; with 200 N/m the force leaves its band for half the way. So the hand is softer, and its
target follows the climb. (Straight ahead, without planning, 130 N/m kept 10 of 10 blocks in the band.)
"""
SINK_M = 0.004
"""The target stays this far below the hand, which adds 0.6 N of drag: else the Panda's fingers climb over the top."""
STEADY = (0.2, 0.2, 0.02, 0.02, 0.02, 0.02, 0.0)
"""Sampling noise while pushing: almost none on height, orientation and opening, which are already right.

With noise, their target wanders (3 cm up, measured), because rollouts hardly distinguish the values.
"""
BELOW_TOP_M = 0.03
"""Height of the tool below the block's top: as low as the palm, 3.7 cm above the tool, allows, with room to climb."""
LOWEST_M = 0.016
"""Lowest height of the tool; the fingertips reach 8 mm below it."""
RECENT = 10
"""Control steps over which forces and velocities are averaged: 0.2 s, as in the task's condition."""


def to_goal(state: Context, name: str) -> Array:
    """Compute the vector from the block to the goal along the table, Shape=(..., 3) m."""
    return np.asarray((state.goal_pos - state[f"{name}_pos"]) * np.array([1.0, 1.0, 0.0]))


def behind(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Compute the pushing point: on the near face, where the line from the goal through the centre leaves the block.

    Pushed at the face's middle, a block that does not face the goal turns (35 deg over 15 cm, measured).
    """
    ahead = axis(state[f"{name}_quat"], "x")
    way = to_goal(state, name) + 0.03 * ahead  # near the goal, where the line means little, the middle after all
    way = way / norm(way)[..., None]
    depth = state[f"{name}_size"][..., 0] / 2 / np.maximum(dot(way, ahead), 0.7)
    point = np.asarray(state[f"{name}_pos"] - way * depth[..., None] - ahead * (PAD_M + gap_m))
    point[..., 2] = np.maximum(state[f"{name}_pos"][..., 2] + state[f"{name}_size"][..., 2] / 2 - BELOW_TOP_M, LOWEST_M)
    return point


def off_face(state: Context, name: str) -> Array:
    """Compute the distance of the tool from that point along the table, and outside a range of heights.

    During contact, friction determines its height: commanded down by 2 cm, the hand drags on the face and pushes with
    twice the force (measured: 13 N, of which 6 along the table).
    """
    off = state.ee_pos - behind(state, name)
    high = np.clip(np.abs(off[..., 2]) - 0.02, 0, None)
    return norm(off[..., :2]) + high


def square(state: Context, name: str) -> Array:
    """Compute the misalignment with palm down and fingers abreast of the near face; linear in small tilts.

    A tilted finger is a wedge: it climbs the face (4 cm, measured) and presses the block down.
    """
    ahead = axis(state[f"{name}_quat"], "x")
    palm = axis(state.ee_quat, "z")
    return norm(palm[..., :2]) + 2.0 * (palm[..., 2] > 0) + 3.0 * np.square(dot(axis(state.ee_quat, "y"), ahead))


def ahead_of(now: Context, name: str) -> Array:
    """Compute points ahead on the line of the push, Shape=(3, 3) m, at least 1 cm below the block's top.

    They are slightly below the height to which the fingers have climbed: a much lower target drags the block down.
    """
    way = to_goal(now, name)[0, 0]
    top = now[f"{name}_pos"][0, 0, 2] + now[f"{name}_size"][0, 0, 2] / 2
    height = max(min(now.ee_pos[0, 0, 2] - SINK_M, top - 0.01), LOWEST_M)
    from_here = np.array([*now.ee_pos[0, 0, :2], height])
    return np.asarray(from_here + np.array([[0.04], [0.065], [0.09]]) * way / max(float(np.linalg.norm(way)), 1e-6))


def recent(values: Array) -> Array:
    """Compute the running mean over the last 0.2 s (10 steps) of a rollout, Shape=(K, H, n).

    A coarse rollout of a sliding block chatters: nearly the same motions of the hand end with the block at 0 or at
    6 cm/s, and their costs differ by a third (measured). Single instants would select a plan by luck.
    """
    total = np.cumsum(values, axis=1)
    count = np.minimum(np.arange(1, values.shape[1] + 1), RECENT)[:, None]
    before = np.zeros_like(total)
    before[:, RECENT:] = total[:, :-RECENT]  # the first steps have fewer predecessors
    return np.asarray((total - before) / count)


def _velocity_error(state: Context, name: str) -> Array:
    """Compute the block's velocity error: wanted is the pace to the goal, rest within 1 cm of it. Shape=(K, H, 3)."""
    way = to_goal(state, name)
    left = norm(way)
    wanted = way / np.maximum(left, 1e-6)[..., None] * (PACE_M_S * level(left, 0.0, 0.01))[..., None]
    return np.asarray((state[f"{name}_vel"] - wanted) * np.array([1.0, 1.0, 0.0]))


def single(task: Task) -> Strategy:
    """Use one cost: get behind the block, then push it evenly, switched by the hand's distance from the face."""
    name = task.objects[0].name

    def cost(state: Context) -> Terms:
        way = to_goal(state, name)
        far = norm(way)
        along = way / np.maximum(far, 1e-6)[..., None]
        left = level(far, 0.012, 0.02)  # arrived: further pressing would only disturb the force
        # Before the block moves, the hand stays 1.5 cm behind its face until it is low enough; afterwards friction
        # determines its height.
        begun = 1 - near(norm(state[f"{name}_pos"] - state[f"{name}_init_pos"]), 0.03)
        from_face = state.ee_pos - behind(state, name)
        high = (1 - begun) * level(np.abs(from_face[..., 2]), 0.006, 0.015)
        gap = (0.015 * high)[..., None] * axis(state[f"{name}_quat"], "x")
        off = (
            norm((from_face + gap)[..., :2])
            + high * np.abs(from_face[..., 2])
            + np.clip(np.abs(from_face[..., 2]) - 0.03, 0, None)
        )
        ready = left * (1 - high) * near(np.clip(off - 0.01, 0, None), 0.02)
        over = np.clip(off - 0.015, 0, 0.05) / 0.05
        wrong = recent(state[f"{name}_hand_force"] - state.push_force[..., None] * along)
        return {
            "reach": 20.0 * left * np.clip(off - 0.005, 0, None),
            "come from above": 30.0 * over * np.clip(0.1 - state.ee_pos[..., 2], 0, 0.1),
            "to the goal": 12.0 * far,
            "not yet": 3.0 * high * state[f"{name}_hand_contact"],
            "evenly": 2.0 * ready * norm(recent(_velocity_error(state, name))),
            "force": 0.05 * ready * norm(wrong),
            "straight": 25.0
            * ready
            * np.clip(norm(state.last_action[..., :2] - PACE_M_S * along[..., :2]) - 0.2, None, 0),
            "no drag": 0.1 * ready * np.abs(wrong[..., 2]),
            "square": 2.0 * square(state, name),
            "abreast": 20.0 * np.abs(state.gripper_target - ABREAST_M),
            "arrived": -7.0 * (1 - left),  # more than the terms for pushing straight
            "let go": (1 - left)
            * (8.0 * norm(state.ee_pos - behind(state, name, 0.03)) + 1.0 * state[f"{name}_hand_contact"]),
        }

    def onward(now: Context) -> Array:
        begun = norm(now[f"{name}_pos"] - now[f"{name}_init_pos"])[0, 0] > 0.005
        if off_face(now, name)[0, 0] < (0.05 if begun else 0.02) and (begun or now[f"{name}_hand_contact"][0, 0] > 0):
            return ahead_of(now, name)
        low = np.abs(now.ee_pos - behind(now, name))[0, 0, 2] < 0.01
        place = behind(now, name, 0.005 if low else 0.02)[0]
        return np.asarray(np.stack([place[0], place[0] + [0, 0, 0.1]]))

    guide = Guide(onward, partial(facing, name=name), ABREAST_M)
    return Strategy("push, single stage", (Stage("push", cost, (guide,), stiffness_n_m=SOFT_N_M, sigma=STEADY),))


def touching_others(state: Context, task: Task) -> Array:
    """Count the contacts of the hand and of the pushed object with the other objects."""
    name, *others = (item.name for item in task.objects)
    touched = [state[f"{other}_hand_contact"] + state[f"{name}_{other}_contact"] for other in others]
    return np.asarray(sum(touched))


def fsm(task: Task) -> Strategy:
    """Get behind, push evenly, past other objects."""
    name, *others = (item.name for item in task.objects)

    def alone(state: Context) -> Terms:
        return {"past others": 5.0 * touching_others(state, task)} if others else {}

    def reach(state: Context) -> Terms:
        terms = reach_terms(state, name, behind(state, name, 0.012), square(state, name), above_m=0.1)
        return {**terms, **alone(state)}

    def push(state: Context) -> Terms:
        way = to_goal(state, name)
        far = norm(way)
        along = way / np.maximum(far, 1e-6)[..., None]
        # As a vector: a drag down the face adds to the block's friction, and both add to the force (10 N, measured,
        # with the block at rest); the norm alone does not distinguish this from pushing.
        wrong = recent(state[f"{name}_hand_force"] - state.push_force[..., None] * along)
        return {
            "to the goal": 4.0 * far,
            "evenly": 2.0 * norm(recent(_velocity_error(state, name))),
            "behind": 6.0 * np.clip(off_face(state, name) - 0.01, 0, None),
            "force": 0.05 * norm(wrong),
            # The spring's target moves straight at constant speed. This has the highest weight: otherwise it wanders 2
            # or 3 cm sideways, where the model sees little difference, and a block heavier than believed stops.
            "straight": 25.0 * norm(state.last_action[..., :2] - PACE_M_S * along[..., :2]),
            "no drag": 0.1 * np.abs(wrong[..., 2]),
            "square": 2.0 * square(state, name),
            **alone(state),
        }

    def let_go(state: Context) -> Terms:
        # A block at the goal is held by its own friction; further pressing would only disturb the force.
        return {
            "away": 8.0 * norm(state.ee_pos - behind(state, name, 0.03)),
            "leave alone": 1.0 * state[f"{name}_hand_contact"],
            "square": 2.0 * square(state, name),
            **alone(state),
        }

    def in_place(now: Context) -> bool:
        off = np.abs(now.ee_pos - behind(now, name, 0.012))[0, 0]
        return bool(norm(off[:2]) < 0.012 and off[2] < 0.007 and square(now, name)[0, 0] < 0.15)

    def lost(now: Context) -> bool:
        return bool(off_face(now, name)[0, 0] > 0.06)

    def arrived(now: Context) -> bool:
        return bool(norm(to_goal(now, name))[0, 0] < 0.018)

    def short(now: Context) -> bool:
        return bool(norm(to_goal(now, name))[0, 0] > 0.024)

    place = abreast(lambda now: behind(now, name, 0.012), partial(facing, name=name))
    above = abreast(lambda now: behind(now, name, 0.012) + np.array([0, 0, 0.1]), partial(facing, name=name))
    gone = Guide(lambda now: behind(now, name, 0.03)[0])
    return Strategy(
        "push, stages",
        (
            Stage("reach", reach, (place, above), until=in_place),
            Stage(
                "push",
                push,
                (Guide(lambda now: ahead_of(now, name)),),
                stiffness_n_m=SOFT_N_M,
                until=arrived,
                next=(("reach", lost),),
                sigma=STEADY,
            ),
            # Equally soft: the target still leads by 5 cm, and a stiffer spring would hit the block (53 N, measured).
            # Guided, because the plan that ends the push leads on over the block.
            Stage("let go", let_go, (gone,), stiffness_n_m=SOFT_N_M, next=(("reach", short),), sigma=0.6),
        ),
    )
