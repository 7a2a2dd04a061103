"""Names of a trial's geoms in pictures, and the geoms that pictures for people leave out."""

from __future__ import annotations

import mujoco

from coral.contact.scene.trial import Trial


def instance_names(model: mujoco.MjModel, trial: Trial) -> dict[int, str]:
    """Map geoms to the movable object that they belong to; every other moving geom is the robot's."""
    bodies = {int(model.body(name).id): name for name in trial.objects}
    robot = {i: "robot" for i, b in enumerate(model.geom_bodyid) if int(b) not in bodies and int(model.body_weldid[b])}
    return robot | {i: bodies[int(b)] for i, b in enumerate(model.geom_bodyid) if int(b) in bodies}


def hidden_geoms(model: mujoco.MjModel, trial: Trial) -> list[int]:
    """List the geoms that pictures for people leave out: collision shapes over visual ones, and the room."""
    ours = {"table", *(fixture.name for fixture in trial.task.fixtures)}
    visual = {int(model.geom_bodyid[k]) for k in range(model.ngeom) if model.geom_group[k] == 1}
    bodies = {model.body(name).id for name in trial.objects}
    return [
        k
        for k in range(model.ngeom)
        if model.geom(k).name not in ours
        and (
            int(model.geom_bodyid[k]) == 0
            or (model.geom_group[k] == 0 and int(model.geom_bodyid[k]) in visual - bodies)
        )
    ]
