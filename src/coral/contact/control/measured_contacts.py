"""What the hand touches in the running episode, from what the robot measures: poses, the wrench, the fingers' opening.

A rollout knows contacts from its own simulation, which believes in wrong masses and in poses that are off by
millimetres. In the episode a part of the hand touches what it is next to if a force is felt or the fingers are held
apart.
"""

from __future__ import annotations

from functools import partial

import mujoco
import numpy as np

from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.context import Context, Lazy, Value
from coral.contact.scene.mujoco_scene import geom_gap
from coral.contact.scene.observation import Observation

GAP_M = 0.004
"""A gap that the errors of tracked poses explain."""
FELT_N = 0.5
"""A force of the surroundings on the hand above this is a touch."""
HELD_M = 0.003
"""Fingers that stay this much wider than commanded are held apart."""
PARTS = ("left", "right", "hand")
"""The fingers, and the palm with the wrist."""


def touched_by(world: PlanningWorld, now: Observation, commanded_opening_m: float) -> dict[str, tuple[str, ...]]:
    """Return what each part of the hand touches: objects, fixtures, the table. Only the world's shapes are used."""
    felt = float(np.linalg.norm(now.wrench[:3])) > FELT_N
    held = now.opening_m > max(commanded_opening_m, 0.0) + HELD_M
    if not felt and not held:
        return dict.fromkeys(PARTS, ())
    model, data = world.placed(now)
    parts = _geoms_of(model, PARTS)
    things = {name: _geoms_of(model, (name,))[name] for name in now.objects}
    things |= {
        model.geom(geom).name: [geom]
        for geom in range(model.ngeom)
        if model.geom_bodyid[geom] == 0 and model.geom(geom).name and model.geom_contype[geom]
    }
    near = {
        part: tuple(name for name, others in things.items() if _gap(model, data, own, others) < GAP_M)
        for part, own in parts.items()
    }
    if felt:
        return near
    # Squeezing alone leaves no net force, and shows only what both fingers hold.
    both = tuple(name for name in near["left"] if name in near["right"] and name in now.objects)
    return {"left": both, "right": both, "hand": ()}


def sunk_into(world: PlanningWorld, now: Observation) -> dict[str, float]:
    """Return how deep (m) the hand is inside each object by the believed poses, which a true pose excludes."""
    model, data = world.placed(now)
    own = [geom for geoms in _geoms_of(model, PARTS).values() for geom in geoms]
    return {
        name: max(0.0, -_gap(model, data, own, geoms)) for name, geoms in _geoms_of(model, tuple(now.objects)).items()
    }


def _geoms_of(model: mujoco.MjModel, bodies: tuple[str, ...]) -> dict[str, list[int]]:
    ids = {name: model.body(name).id for name in bodies}
    return {name: [geom for geom in range(model.ngeom) if model.geom_bodyid[geom] == ids[name]] for name in bodies}


def _gap(model: mujoco.MjModel, data: mujoco.MjData, first: list[int], second: list[int]) -> float:
    """Return the smallest distance (m) between two sets of geoms, at most 5 cm."""
    return min((geom_gap(model, data, one, other, 0.05)[0] for one in first for other in second), default=0.05)


def with_measured_contacts(state: Context, now: Observation, touched: dict[str, tuple[str, ...]]) -> Context:
    """Return a state, a batch of one, with the hand's measured contacts and forces in place of the predicted ones."""
    values: dict[str, Value] = {"ee_force": now.wrench[None, None, :3], "ee_torque": now.wrench[None, None, 3:]}
    alone = {name for names in touched.values() for name in names}
    for name in now.objects:
        for part in ("left", "right"):
            values[f"{name}_{part}_contact"] = np.full((1, 1), float(name in touched[part]))
    for name in (key.removesuffix("_hand_contact") for key in state.names() if key.endswith("_hand_contact")):
        values[f"{name}_palm_contact"] = np.full((1, 1), float(name in touched["hand"]))
        any_part = any(name in names for names in touched.values())
        values[f"{name}_hand_contact"] = np.full((1, 1), float(any_part))
        if not any_part:
            values[f"{name}_hand_force"] = np.zeros((1, 1, 3))
        elif alone == {name}:
            values[f"{name}_hand_force"] = -now.wrench[None, None, :3]
    kept = {name: partial(state.source, name) for name in state.names()}
    return Context(Lazy({**kept, **{name: values[name] for name in values if name in kept}}), state.shape)
