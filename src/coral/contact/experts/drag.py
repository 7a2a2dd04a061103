"""Dragging: press on an object from above and move it along the table, by the friction under the fingertips.

A card under a shelf, a tile, a sponge: too flat to be pushed from behind or grasped. A finger pad grips better than the
table (friction 1 against 0.3 to 0.5), so an object that is pressed goes where the hand goes. The hand is soft, so that
its target below the surface sets the force.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.experts.abreast import DOWN
from coral.contact.experts.push import recent
from coral.contact.experts.terms import level, norm, turned
from coral.contact.scene.history_conditions import SteadyForce
from coral.contact.scene.state_conditions import Touching
from coral.contact.scene.task import Task

Array = NDArray[np.float64]
TIP_M = 0.008
"""Distance from the tool to the fingertips."""
PRESS_N = 6.0
"""Pressing force where the task asks for none: traction for three times the friction of what is dragged."""
PACE_M_S = 0.05
"""Speed of the drag."""
SOFT_N_M = 200.0
"""The 6 cm by which a target may lead the hand make 12 N: enough for every pressure that a task asks for."""
ARRIVED_M = 0.012
"""Distance at which a place is reached."""


def over(state: Context, name: str, gap_m: float = 0.0) -> Array:
    """Compute the tool position with the fingertips on the object's point `grip`, or above it, Shape=(..., 3) m."""
    return np.asarray(state[f"{name}_grip_pos"] + np.array([0.0, 0.0, TIP_M + gap_m]))


def to_place(state: Context, name: str, place: str) -> Array:
    """Compute the vector from the object to a place along the table, Shape=(..., 3) m."""
    return np.asarray((state[f"{place}_pos"] - state[f"{name}_pos"]) * np.array([1.0, 1.0, 0.0]))


def fsm(task: Task) -> Strategy:
    """Come down on the object, press and drag it to each place of the file in its order, rise."""
    name = task.objects[0].name
    places = list(task.places)
    press_n = next((one.newtons for one in task.success.conditions if isinstance(one, SteadyForce)), PRESS_N)
    stops = [one.thing for one in task.success.conditions if isinstance(one, Touching) and one.object == name]

    def reach(state: Context) -> Terms:
        return {
            "reach": 12.0 * norm(state.ee_pos - over(state, name, 0.012)),
            "square": 4.0 * turned(state.ee_quat, DOWN),
            "closed": 20.0 * np.abs(state.gripper_target),
            "leave alone": 0.2 * norm(state[f"{name}_hand_force"]),
        }

    def drag(place: str, state: Context) -> Terms:
        way = to_place(state, name, place)
        left = norm(way)
        along = way / np.maximum(left, 1e-6)[..., None]
        wanted = along * (PACE_M_S * level(left, 0.0, 0.01))[..., None]
        pressed = -recent(state[f"{name}_hand_force"])[..., 2]
        return {
            "to the place": 10.0 * left,
            "evenly": 2.0 * norm(recent((state[f"{name}_vel"] - wanted) * np.array([1.0, 1.0, 0.0]))),
            "on it": 15.0 * norm((state.ee_pos - over(state, name))[..., :2]),
            "press": 0.15 * np.abs(pressed - press_n),
            "straight": 10.0 * norm(state.last_action[..., :2] - wanted[..., :2]),
            "square": 3.0 * turned(state.ee_quat, DOWN),
            "closed": 10.0 * np.abs(state.gripper_target),
        }

    def let_go(state: Context) -> Terms:
        return {
            "away": 8.0 * norm(state.ee_pos - over(state, name, 0.06)),
            "let go": 1.0 * state[f"{name}_hand_contact"],
            "leave alone": 5.0 * norm(state[f"{name}_vel"]),
            "square": 2.0 * turned(state.ee_quat, DOWN),
        }

    def in_place(now: Context) -> bool:
        return bool(norm(now.ee_pos - over(now, name, 0.012))[0, 0] < 0.012)

    def lost(now: Context) -> bool:
        return bool(norm((now.ee_pos - over(now, name))[..., :2])[0, 0] > 0.04)

    def arrived(place: str, now: Context) -> bool:
        stopped = any(now[f"{name}_{thing}_contact"][0, 0] > 0 for thing in stops)
        return bool(stopped or norm(to_place(now, name, place))[0, 0] < ARRIVED_M)

    def ahead(place: str, now: Context) -> Array:
        """Compute a point ahead of the hand, as far below the surface as the pressing force needs."""
        way = to_place(now, name, place)[0, 0]
        point = now.ee_pos[0, 0] + 0.04 * way / max(float(np.linalg.norm(way)), 0.04)
        point[2] = over(now, name)[0, 0, 2] - press_n / SOFT_N_M
        return np.asarray(point[None])

    def stroke(place: str) -> Stage:
        return Stage(
            f"drag to {place}",
            lambda state: drag(place, state),
            (Guide(lambda now: ahead(place, now), lambda now: DOWN, 0.0),),
            stiffness_n_m=SOFT_N_M,
            until=lambda now: arrived(place, now),
            next=(("reach", lost),) if place == places[0] else (),
            sigma=0.4,
        )

    rise = Guide(lambda now: over(now, name, 0.06)[0], lambda now: DOWN, 0.0)
    return Strategy(
        "press and drag",
        (
            Stage(
                "reach", reach, (Guide(lambda now: over(now, name, 0.012)[0], lambda now: DOWN, 0.0),), until=in_place
            ),
            *(stroke(place) for place in places),
            Stage("let go", let_go, (rise,), sigma=0.6),
        ),
    )
