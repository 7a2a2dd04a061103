"""The state that commands under way lead to, by the planning world under the best belief."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.cost.context import Array, Context
from coral.contact.scene.observation import BodyState, HandTarget, Observation


def state_after(world: PlanningWorld, now: Observation, targets: Sequence[HandTarget], step: int) -> Observation:
    """Return the state once the hand has followed targets of one stiffness, one a step; none: the present state."""
    states = states_under(world, now, targets, step) if targets else None
    return now if states is None else observation_of(states, now)


def states_under(world: PlanningWorld, now: Observation, targets: Sequence[HandTarget], step: int) -> Context | None:
    """Return the state after each control step of following targets, Shape=(1, n); None if it diverges."""
    controls = ControlSequences(
        np.array([target.position for target in targets])[None],
        np.array([target.quaternion for target in targets])[None],
        np.array([[target.opening_m for target in targets]]),
        targets[0].stiffness,
    )
    states, sane = world.rollout(now, controls, step)
    return states if sane[0] else None


def observation_of(states: Context, like: Observation, index: int = -1) -> Observation:
    """Return a state of the first sequence, by default the last, as an observation of the same objects as in `like`."""

    def at(name: str) -> Array:
        value: Array = np.asarray(states[name])[0, index]
        return value

    def body(name: str, turn: str = "angvel") -> BodyState:
        return BodyState(at(f"{name}_pos"), at(f"{name}_quat"), at(f"{name}_vel"), at(f"{name}_{turn}"))

    return Observation(
        time_s=float(at("time")),
        tool=body("ee"),
        opening_m=float(np.clip(at("gripper_opening"), 0.0, None)),
        wrench=np.concatenate([at("ee_force"), at("ee_torque")]),
        objects={name: body(name) for name in like.objects},
        unseen=like.unseen,
        lost=like.lost,
    )
