"""The state that commands under way lead to, by the planning world under the best belief."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.cost.context import Array, Context
from coral.contact.scene.observation import BodyState, HandTarget, Observation


def state_after(world: PlanningWorld, now: Observation, targets: Sequence[HandTarget], step: int) -> Observation:
    """Return the state once the hand has followed some targets.

    Args:
        world: The planning world.
        now: The measured state.
        targets: One for each control step, all of one stiffness; none: the present state.
        step: Control steps since the episode began.
    """
    if not targets:
        return now
    controls = ControlSequences(
        np.array([target.position for target in targets])[None],
        np.array([target.quaternion for target in targets])[None],
        np.array([[target.opening_m for target in targets]]),
        targets[0].stiffness,
    )
    states, sane = world.rollout(now, controls, step)
    return observation_of(states, now) if sane[0] else now


def observation_of(states: Context, like: Observation) -> Observation:
    """Return the last state of the first sequence as an observation.

    Args:
        states: Rolled-out states.
        like: An observation of the same objects.
    """

    def last(name: str) -> Array:
        value: Array = np.asarray(states[name])[0, -1]
        return value

    def body(name: str, turn: str = "angvel") -> BodyState:
        return BodyState(last(f"{name}_pos"), last(f"{name}_quat"), last(f"{name}_vel"), last(f"{name}_{turn}"))

    return Observation(
        time_s=float(np.asarray(states["time"])[0, -1]),
        tool=body("ee"),
        opening_m=float(np.clip(last("gripper_opening"), 0.0, None)),
        wrench=np.concatenate([last("ee_force"), last("ee_torque")]),
        objects={name: body(name) for name in like.objects},
    )
