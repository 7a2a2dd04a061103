"""The planning world: a reduced model of hand and scene, built from beliefs, in which action sequences are rehearsed.

It is MuJoCo with the floating hand of `hand.py`, coarse steps and cheap contacts, rolled out in a batch on all cores by
`mujoco.rollout`. Contacts are read by sensors, as a rollout has no other way out.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
from mujoco import rollout as mujoco_rollout
from numpy.typing import NDArray

from coral.config import TimeStep
from coral.contact.context import HAND, Context, Quantity, object_quantities
from coral.contact.draw import Drawn, Physical
from coral.contact.geometry import multiply, rotate
from coral.contact.hand import HandCfg, add_hand, set_stiffness
from coral.contact.scene import add_scene, believing, contact_pairs
from coral.contact.world import Body, Observation

Array = NDArray[np.float64]
CONTROL = int(mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_MOCAP_POS | mujoco.mjtState.mjSTATE_MOCAP_QUAT)
FOUND, FORCE, NET = 1, 2, 3
SANE_SPEED_M_S = 8.0
"""A rollout in which anything moves faster has diverged."""


@dataclass(frozen=True, kw_only=True)
class PlanningCfg:
    """How coarse the rehearsal is.

    Args:
        step_s: One control step of the plan.
        physics_dt_s: Step of the physics; a whole number of them makes a control step. 10 ms keeps the box within 12 mm of a
            1 ms reference over a second of pushing (measured), and costs a fifth of 2 ms.
        threads: Of the rollout; 0 takes every core.
        hand: The hand's apparent dynamics.
    """

    step_s: TimeStep = 0.02
    physics_dt_s: TimeStep = 0.01
    threads: int = 0
    hand: HandCfg = field(default_factory=HandCfg)


@dataclass(frozen=True)
class Controls:
    """What a batch of rehearsals does, one row for each control step.

    Args:
        position: Shape=(K, H, 3) m, target of the tool.
        quaternion: Shape=(K, H, 4).
        opening: Shape=(K, H) m.
        stiffness: N/m, for all.
    """

    position: Array
    quaternion: Array
    opening: Array
    stiffness: float


class PlanningWorld:
    """A belief about the scene in which action sequences can be tried.

    Args:
        drawn: The trial; its sizes and shapes are known, its masses and frictions are replaced by `beliefs`.
        beliefs: One belief for each object, or several sets of them, over which a plan's risk is taken.
        start: The first observation; what the costs call `_init_`.
        cfg: How coarse.
    """

    def __init__(self, drawn: Drawn, beliefs: Mapping[str, Physical] | Sequence[Mapping[str, Physical]],
                 start: Observation, cfg: PlanningCfg) -> None:
        self.cfg = cfg
        self._drawn, self._start = drawn, start
        self._substeps = round(cfg.step_s / cfg.physics_dt_s)
        self._pool = mujoco_rollout.Rollout(nthread=cfg.threads or os.cpu_count() or 1)
        self._names = [item.name for item in drawn.task.objects]
        self.believe(beliefs)
        self._datas = [mujoco.MjData(self.models[0]) for _ in range(cfg.threads or os.cpu_count() or 1)]

    def believe(self, beliefs: Mapping[str, Physical] | Sequence[Mapping[str, Physical]]) -> None:
        """Rebuild the models with new masses and frictions."""
        sets = [beliefs] if isinstance(beliefs, Mapping) else list(beliefs)
        self.beliefs: list[Mapping[str, Physical]] = sets
        self.models = [build_model(believing(self._drawn, one), self.cfg) for one in sets]
        self._index = _Index(self.models[0], self._names)

    def close(self) -> None:
        """Stop the rollout's threads."""
        self._pool.close()

    @property
    def schema(self) -> dict[str, Quantity]:
        """What a cost can read here."""
        return task_schema_of(self._drawn)

    def rollout(self, now: Observation, controls: Controls, step: int = 0) -> tuple[Context, NDArray[np.bool_]]:
        """Rehearse K sequences from the state now, under each belief.

        Args:
            now: The measured state.
            controls: What each rehearsal does.
            step: Control steps since the episode began.

        Returns:
            The states after each control step, K being beliefs x sequences in that order, and which rehearsals hold,
            Shape=(K,): those that diverged do not, and their states are repeated from the last sane one.
        """
        count, horizon = controls.opening.shape
        total = count * len(self.models)
        for model in self.models:
            set_stiffness(model, self.cfg.hand, controls.stiffness)
        initial = self._initial(now)
        control = np.zeros((count, horizon, self.models[0].nu + 7))
        control[:, :, 0] = control[:, :, 1] = controls.opening / 2
        control[:, :, -7:-4] = controls.position
        control[:, :, -4:] = controls.quaternion
        control = np.repeat(control, self._substeps, axis=1)
        models: list[mujoco.MjModel] = [model for model in self.models for _ in range(count)]
        states, sensors = self._pool.rollout(
            models, self._datas, np.repeat(initial[None], total, axis=0),
            np.tile(control, (len(self.models), 1, 1)), control_spec=CONTROL)
        states = np.asarray(states)[:, self._substeps - 1::self._substeps]
        sensors = np.asarray(sensors)[:, self._substeps - 1::self._substeps]
        states, sensors, sane = _without_divergence(states, sensors, self._index.speeds)
        values = self._values(states, sensors, controls, now, step)
        return Context(values, (total, horizon)), sane

    def present(self, now: Observation, step: int = 0) -> Context:
        """The measured state as a batch of one, contacts as the model holds them one step on with the hand kept still."""
        still = Controls(now.tool.position[None, None], now.tool.quaternion[None, None],
                         np.full((1, 1), now.opening_m), self.cfg.hand.stiffness_n_m)
        context, _ = self.rollout(now, still, step)
        return context

    def _initial(self, now: Observation) -> Array:
        model, data = self.models[0], self._datas[0]
        mujoco.mj_resetData(model, data)
        data.time = now.time_s
        put_state(model, data, now)
        state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        return state

    def _values(self, states: Array, sensors: Array, controls: Controls, now: Observation, step: int) -> dict[str, Array]:
        index, horizon = self._index, states.shape[1]
        qpos, qvel = states[..., 1:1 + index.nq], states[..., 1 + index.nq:1 + index.nq + index.nv]
        values: dict[str, Array] = {
            "ee_pos": sensors[..., index.sensor["ee_pos"]], "ee_quat": sensors[..., index.sensor["ee_quat"]],
            "ee_vel": sensors[..., index.sensor["ee_vel"]], "ee_angvel": sensors[..., index.sensor["ee_angvel"]],
            "gripper_opening": qpos[..., index.left] + qpos[..., index.right],
            "gripper_target": np.tile(controls.opening, (len(self.models), 1)),
            "ee_force": -sensors[..., index.sensor["hand_anything"]][..., 1:4],
            "time": (now.time_s + self.cfg.step_s * np.arange(1, horizon + 1))[None],
            "current_step": (step + np.arange(1.0, horizon + 1))[None],
            "last_action": _action(controls, len(self.models), self.cfg.step_s),
        }
        for name in self._names:
            pose, speed = index.pose[name], index.speed[name]
            quaternion = qpos[..., pose.start + 3:pose.stop]
            values[f"{name}_pos"] = qpos[..., pose.start:pose.start + 3]
            values[f"{name}_quat"] = quaternion
            values[f"{name}_vel"] = qvel[..., speed.start:speed.start + 3]
            # A free joint's angular velocity is held in the body's own axes.
            values[f"{name}_angvel"] = rotate(quaternion, qvel[..., speed.start + 3:speed.stop])
            touch = sensors[..., index.sensor[f"hand_{name}"]]
            values[f"{name}_hand_contact"] = (touch[..., 0] > 0).astype(float)
            values[f"{name}_hand_force"] = touch[..., 1:4]
            for side in ("left", "right"):
                values[f"{name}_{side}_contact"] = (sensors[..., index.sensor[f"{side}_{name}"]][..., 0] > 0).astype(float)
            for point, local in self._drawn.task.object(name).points.items():
                offset = np.asarray(local) * self._drawn.objects[name].scale
                values[f"{name}_{point}_pos"] = values[f"{name}_pos"] + rotate(quaternion, offset)
        for name, other in contact_pairs(self._drawn):
            values[f"{name}_{other}_contact"] = (
                sensors[..., index.sensor[_pair(name, other)]][..., 0] > 0).astype(float)
        values |= constants(self._drawn, self._start, self.beliefs, states.shape[0])
        return values


def constants(drawn: Drawn, start: Observation, beliefs: Sequence[Mapping[str, Physical]], total: int) -> dict[str, Array]:
    """What does not change in a rollout: sizes, beliefs, first poses, places and numbers of the task."""
    task = drawn.task
    found: dict[str, Array] = {}
    for item in task.objects:
        name, body = item.name, start.objects[item.name]
        found[f"{name}_init_pos"] = body.position[None, None]
        found[f"{name}_init_quat"] = body.quaternion[None, None]
        found[f"{name}_size"] = drawn.size(name)[None, None]
        for key, read in (("mass", lambda one: one.mass_kg), ("friction", lambda one: one.friction)):
            each = np.array([read(one[name]) for one in beliefs])
            found[f"{name}_{key}"] = np.repeat(each, total // len(beliefs))[:, None]
    half = np.asarray(task.table.size) / 2
    center = np.array([*task.table.center, 0.0])
    found["table_min"] = (center - [half[0], half[1], 2 * half[2]])[None, None]
    found["table_max"] = (center + [half[0], half[1], 0.0])[None, None]
    for fixture in task.fixtures:
        found[f"{fixture.name}_pos"] = np.asarray(fixture.position)[None, None]
        found[f"{fixture.name}_size"] = np.asarray(fixture.size)[None, None]
    for name, place in task.places.items():
        found[f"{name}_pos"] = np.asarray(place)[None, None]
    for name, number in task.numbers.items():
        found[name] = np.full((1, 1), number)
    return found


def task_schema_of(drawn: Drawn) -> dict[str, Quantity]:
    """What a cost for this task can read."""
    task = drawn.task
    schema = dict(HAND)
    for item in task.objects:
        others = [other.name for other in task.objects if other.name != item.name]
        schema |= object_quantities(item.name, item.points, task.things, others)
    schema["table_min"] = Quantity(3, "m", "corner of the table with the smallest coordinates", constant=True)
    schema["table_max"] = Quantity(3, "m", "corner of the table with the largest coordinates", constant=True)
    for fixture in task.fixtures:
        schema[f"{fixture.name}_pos"] = Quantity(3, "m", f"centre of the {fixture.name}", constant=True)
        schema[f"{fixture.name}_size"] = Quantity(3, "m", f"full extents of the {fixture.name}", constant=True)
    for name in task.places:
        schema[f"{name}_pos"] = Quantity(3, "m", f"the place {name} of the task", constant=True)
    for name in task.numbers:
        schema[name] = Quantity(0, "", f"the number {name} of the task", constant=True)
    return schema


def build_model(drawn: Drawn, cfg: PlanningCfg) -> mujoco.MjModel:
    """The reduced model: implicitfast, pyramidal cones, few contacts a pair, no islands (measured choices)."""
    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep = cfg.physics_dt_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    option.iterations, option.ls_iterations = 20, 20
    option.disableflags |= int(getattr(mujoco.mjtDisableBit, "mjDSBL_ISLAND", 0))
    add_scene(spec, drawn, condim=3)
    add_hand(spec, cfg.hand, condim=3)
    _add_sensors(spec, drawn)
    model = spec.compile()
    set_stiffness(model, cfg.hand, cfg.hand.stiffness_n_m)
    return model


def _pair(name: str, other: str) -> str:
    return f"{name}_{other}"


def _add_sensors(spec: mujoco.MjSpec, drawn: Drawn) -> None:
    for name, kind in (("ee_pos", mujoco.mjtSensor.mjSENS_FRAMEPOS), ("ee_quat", mujoco.mjtSensor.mjSENS_FRAMEQUAT),
                       ("ee_vel", mujoco.mjtSensor.mjSENS_FRAMELINVEL),
                       ("ee_angvel", mujoco.mjtSensor.mjSENS_FRAMEANGVEL)):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="tool")
    subtree, geom, body = mujoco.mjtObj.mjOBJ_XBODY, mujoco.mjtObj.mjOBJ_GEOM, mujoco.mjtObj.mjOBJ_BODY

    def contact(name: str, first: tuple[mujoco.mjtObj, str], second: tuple[mujoco.mjtObj, str] | None, data: int) -> None:
        sensor = spec.add_sensor(name=name, type=mujoco.mjtSensor.mjSENS_CONTACT, objtype=first[0], objname=first[1])
        if second is not None:
            sensor.reftype, sensor.refname = second
        sensor.intprm[:3] = [data, NET, 1]

    contact("hand_anything", (subtree, "hand"), None, FOUND | FORCE)
    fixed = set(drawn.task.things)
    for item in drawn.task.objects:
        contact(f"hand_{item.name}", (subtree, "hand"), (subtree, item.name), FOUND | FORCE)
        for side in ("left", "right"):
            contact(f"{side}_{item.name}", (body, side), (body, item.name), FOUND)
    for name, other in contact_pairs(drawn):
        contact(_pair(name, other), (body, name), (geom if other in fixed else body, other), FOUND)


class _Index:
    """Where things lie in the state and the sensor vectors."""

    def __init__(self, model: mujoco.MjModel, names: Sequence[str]) -> None:
        self.nq, self.nv = model.nq, model.nv
        self.left, self.right = (int(model.joint(f"{side}_slide").qposadr[0]) for side in ("left", "right"))
        self.pose, self.speed = {}, {}
        for name in names:
            joint = model.joint(f"{name}_free")
            self.pose[name] = slice(int(joint.qposadr[0]), int(joint.qposadr[0]) + 7)
            self.speed[name] = slice(int(joint.dofadr[0]), int(joint.dofadr[0]) + 6)
        self.sensor = {model.sensor(k).name: slice(int(model.sensor_adr[k]), int(model.sensor_adr[k] + model.sensor_dim[k]))
                       for k in range(model.nsensor)}
        linear = [k for name in names for k in range(self.speed[name].start, self.speed[name].start + 3)]
        self.speeds = np.array(linear) + 1 + model.nq


def put_state(model: mujoco.MjModel, data: mujoco.MjData, now: Observation) -> None:
    """Write a measured state into a model that has the floating hand."""
    start = int(model.joint("hand_x").qposadr[0])
    data.qpos[start:start + 3] = now.tool.position
    data.qpos[start + 3:start + 7] = now.tool.quaternion
    dof = int(model.joint("hand_x").dofadr[0])
    data.qvel[dof:dof + 3] = now.tool.velocity
    data.qvel[dof + 3:dof + 6] = _own_axes(now.tool)
    for side in ("left", "right"):
        data.qpos[int(model.joint(f"{side}_slide").qposadr[0])] = now.opening_m / 2
    for name, body in now.objects.items():
        joint = model.joint(f"{name}_free")
        place, speed = int(joint.qposadr[0]), int(joint.dofadr[0])
        data.qpos[place:place + 3] = body.position
        data.qpos[place + 3:place + 7] = body.quaternion
        data.qvel[speed:speed + 3] = body.velocity
        data.qvel[speed + 3:speed + 6] = _own_axes(body)


def _own_axes(body: Body) -> Array:
    return rotate(body.quaternion * np.array([1.0, -1, -1, -1]), body.angular_velocity)


def _without_divergence(states: Array, sensors: Array, speeds: NDArray[np.int_]) -> tuple[Array, Array, NDArray[np.bool_]]:
    bad = ~np.isfinite(states).all(axis=-1) | (np.abs(states[..., speeds]) > SANE_SPEED_M_S).any(axis=-1)
    bad |= ~np.isfinite(sensors).all(axis=-1)
    sane = ~bad.any(axis=1)
    for k in np.flatnonzero(~sane):
        first = int(np.argmax(bad[k]))
        states[k, first:] = states[k, first - 1] if first else np.nan_to_num(states[k, 0], posinf=0.0, neginf=0.0)
        sensors[k, first:] = sensors[k, first - 1] if first else 0.0
    return states, sensors, sane


def _action(controls: Controls, repeats: int, step_s: float) -> Array:
    """Shape=(K, H, 7): speeds of the commanded pose and opening."""
    move = np.diff(controls.position, axis=1, prepend=controls.position[:, :1]) / step_s
    q = controls.quaternion
    before = np.concatenate([q[:, :1], q[:, :-1]], axis=1) * np.array([1.0, -1, -1, -1])
    turn = 2.0 * multiply(q, before)[..., 1:] / step_s
    grip = np.diff(controls.opening, axis=1, prepend=controls.opening[:, :1])[..., None] / step_s
    return np.tile(np.concatenate([move, turn, grip], axis=-1), (repeats, 1, 1))
