"""Names of a trial's geoms in pictures, and the geoms that pictures for people leave out."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from coral.contact.scene.trial import Trial


def instance_names(model: mujoco.MjModel, trial: Trial) -> dict[int, str]:
    """Map geoms to the movable object that they belong to; every other moving geom is the robot's."""
    bodies = {int(model.body(name).id): name for name in trial.objects}
    robot = {i: "robot" for i, b in enumerate(model.geom_bodyid) if int(b) not in bodies and int(model.body_weldid[b])}
    return robot | {i: bodies[int(b)] for i, b in enumerate(model.geom_bodyid) if int(b) in bodies}


def covered_geoms(model: mujoco.MjModel, apart: Iterable[str] = ()) -> list[int]:
    """List the collision shapes (group 0) of bodies that have visual ones (group 1); not those of some bodies."""
    plain, visual = (np.flatnonzero(model.geom_group == group) for group in (0, 1))
    bodies = {*model.geom_bodyid[visual].tolist()} - {0, *(int(model.body(name).id) for name in apart)}
    return [int(geom) for geom in plain if int(model.geom_bodyid[geom]) in bodies]


def hidden_geoms(model: mujoco.MjModel, trial: Trial) -> list[int]:
    """List the geoms that pictures for people leave out: collision shapes over visual ones, and the room."""
    task = trial.task
    ours = {"table", *(fixture.name for fixture in task.fixtures), *(f"mark/{mark.place}" for mark in task.marks)}
    room = [int(k) for k in np.flatnonzero(model.geom_bodyid == 0) if model.geom(int(k)).name not in ours]
    return [*room, *covered_geoms(model, trial.objects)]
