"""The reduced MuJoCo model of a believed scene: coarse steps, cheap contacts, contact sensors."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from coral.contact.control.hand_model import FINGER_KG, HandCfg, add_hand, set_stiffness
from coral.contact.scene.mujoco_scene import add_scene, contact_pairs
from coral.contact.scene.trial import Trial

FOUND, FORCE, TORQUE, PLACE, NET = 1, 2, 4, 16, 3
"""Bits of a contact sensor's data, and its reduction of several contacts."""

MOTION = {
    "pos": mujoco.mjtSensor.mjSENS_FRAMEPOS,
    "quat": mujoco.mjtSensor.mjSENS_FRAMEQUAT,
    "vel": mujoco.mjtSensor.mjSENS_FRAMELINVEL,
    "angvel": mujoco.mjtSensor.mjSENS_FRAMEANGVEL,
}
"""Sensors of an object on a joint."""
SWING_RAD = 0.8
"""Maximum rotation of a finger on its spring in one step. A finger of 50 g rotates by 1.4 rad in 10 ms: a squeezed
box of 0.1 kg was thrown out within a second in 22 of 33 rollouts that only held it (measured), with the limit in
none."""


def build_model(trial: Trial, hand: HandCfg, physics_dt_s: float, endless: bool = False) -> mujoco.MjModel:
    """Compile the reduced model with the hand's default stiffness."""
    spec = reduced(trial, hand, physics_dt_s)
    if endless:
        table = spec.geom("table")
        table.type, table.size = mujoco.mjtGeom.mjGEOM_PLANE, [0, 0, 1]
        table.pos = [*trial.task.table.center, 0]
    model = spec.compile()
    set_stiffness(model, hand, hand.stiffness_n_m)
    return model


def reduced(trial: Trial, hand: HandCfg, physics_dt_s: float) -> mujoco.MjSpec:
    """Model hand and scene: implicitfast, pyramidal cones, few contacts per pair (measured choices)."""
    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep = physics_dt_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    option.iterations, option.ls_iterations = 20, 20
    option.disableflags |= int(getattr(mujoco.mjtDisableBit, "mjDSBL_MULTICCD", 0))  # cylinders touch at one point
    if len(trial.task.objects) == 1:  # alone, islands cost 1 %; with the four objects of pick-clutter they save 11 %
        option.disableflags |= int(getattr(mujoco.mjtDisableBit, "mjDSBL_ISLAND", 0))
    add_scene(spec, trial, condim=3)
    add_hand(spec, hand, condim=3)
    for side in ("left", "right"):
        needed = hand.finger_stiffness_n_m * (physics_dt_s / SWING_RAD) ** 2
        spec.joint(f"{side}_slide").armature = max(0.0, needed - FINGER_KG)
    _add_sensors(spec, trial)
    return spec


def pair(name: str, other: str) -> str:
    """Return the name of a pair's contact sensor; no name contains a slash, so no two pairs share one."""
    return f"{name}/{other}"


def _add_sensors(spec: mujoco.MjSpec, trial: Trial) -> None:
    for name, kind in (
        ("ee_pos", mujoco.mjtSensor.mjSENS_FRAMEPOS),
        ("ee_quat", mujoco.mjtSensor.mjSENS_FRAMEQUAT),
        ("ee_vel", mujoco.mjtSensor.mjSENS_FRAMELINVEL),
        ("ee_angvel", mujoco.mjtSensor.mjSENS_FRAMEANGVEL),
    ):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="tool")
    subtree, geom, body = mujoco.mjtObj.mjOBJ_XBODY, mujoco.mjtObj.mjOBJ_GEOM, mujoco.mjtObj.mjOBJ_BODY

    def contact(
        name: str, first: tuple[mujoco.mjtObj, str], second: tuple[mujoco.mjtObj, str] | None, data: int
    ) -> None:
        sensor = spec.add_sensor(name=name, type=mujoco.mjtSensor.mjSENS_CONTACT, objtype=first[0], objname=first[1])
        if second is not None:
            sensor.reftype, sensor.refname = second
        sensor.intprm[:3] = [data, NET, 1]

    contact("hand_anything", (subtree, "hand"), None, FOUND | FORCE | TORQUE | PLACE)
    fixed = set(trial.task.things)
    for item in trial.task.objects:
        if item.joint is not None:
            for kind, sensor in MOTION.items():
                spec.add_sensor(name=pair(item.name, kind), type=sensor, objtype=subtree, objname=item.name)
        contact(pair("hand", item.name), (subtree, "hand"), (subtree, item.name), FOUND | FORCE)
        contact(pair("palm", item.name), (body, "hand"), (subtree, item.name), FOUND)
        for side in ("left", "right"):
            contact(pair(side, item.name), (body, side), (body, item.name), FOUND)
    for thing in trial.task.things:
        contact(pair("hand", thing), (subtree, "hand"), (geom, thing), FOUND | FORCE)
        contact(pair("palm", thing), (body, "hand"), (geom, thing), FOUND)
    for name, other in contact_pairs(trial):
        if other in fixed or name < other:  # a pair of objects has one sensor
            contact(pair(name, other), (body, name), (geom if other in fixed else body, other), FOUND)


class Index:
    """Indices into the state and the sensor vectors; an object on a joint has sensors instead of a pose."""

    def __init__(self, model: mujoco.MjModel, names: Sequence[str]) -> None:
        self.nq, self.nv = model.nq, model.nv
        self.left, self.right = (int(model.joint(f"{side}_slide").qposadr[0]) for side in ("left", "right"))
        self.pose, self.speed = {}, {}
        free = [name for name in names if model.jnt_type[model.body(name).jntadr[0]] == mujoco.mjtJoint.mjJNT_FREE]
        for name in free:
            joint = model.joint(f"{name}_free")
            self.pose[name] = slice(int(joint.qposadr[0]), int(joint.qposadr[0]) + 7)
            self.speed[name] = slice(int(joint.dofadr[0]), int(joint.dofadr[0]) + 6)
        ends = zip(model.sensor_adr, model.sensor_adr + model.sensor_dim, strict=True)
        self.joint = {name: int(model.joint(f"{name}_joint").qposadr[0]) for name in names if name not in free}
        self.sensor = {model.sensor(k).name: slice(int(low), int(high)) for k, (low, high) in enumerate(ends)}
        linear = [k for name in free for k in range(self.speed[name].start, self.speed[name].start + 3)]
        jointed = [int(model.joint(f"{name}_joint").dofadr[0]) for name in names if name not in free]
        self.speeds = np.array(linear + jointed) + 1 + model.nq
