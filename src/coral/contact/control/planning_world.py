"""The planning world: a reduced model of hand and scene, built from beliefs, for rolling out control sequences.

It is MuJoCo with the floating hand of `hand_model.py`, coarse steps and cheap contacts, rolled out in a batch on all
cores by `mujoco.rollout`. Sensors read the contacts, since a rollout returns nothing else.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import NonNegative, Positive, TimeStep, whole_steps
from coral.contact.control.clearance import clearances
from coral.contact.control.hand_model import HandCfg, set_stiffness
from coral.contact.control.planning_model import MOTION, Index, build_model, pair
from coral.contact.control.quantities import constants, stage_constants, task_schema_of
from coral.contact.control.rollouts import FULL, SLEEP, Rollouts, RolloutStart
from coral.contact.control.warp_rollouts import WarpRollouts
from coral.contact.cost.context import Context, Lazy, Value
from coral.contact.scene.geometry import multiply, rotate
from coral.contact.scene.mujoco_scene import contact_pairs
from coral.contact.scene.observation import Array, BodyState, Observation
from coral.contact.scene.trial import PhysicalParameters, Trial, joint_speed, with_beliefs

CONTROL = int(mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_MOCAP_POS | mujoco.mjtState.mjSTATE_MOCAP_QUAT)
FORCE, TORQUE, PLACE = slice(1, 4), slice(4, 7), slice(7, 10)
"""Data of a contact sensor after its count: net force, torque about a point, and that point."""
SANE_SPEED_M_S = 8.0
"""A rollout with a higher speed of anything has diverged."""


@dataclass(frozen=True, kw_only=True)
class PlanningCfg:
    """Time steps and approximations of rollouts."""

    step_s: TimeStep = 0.02
    """One control step of the plan."""
    physics_dt_s: TimeStep = 0.01
    """Physics step; a control step is a whole number of them. 10 ms keeps the box within 12 mm of a 1 ms reference over
    a second of pushing (measured), and costs a fifth of 2 ms."""
    inland_m: Positive = 0.12
    """While the hand and all moving objects are this far from the table's edges, rollouts take the table as a plane:
    contact between cylinder and box needs a general search, with a plane a formula. This matters for cylinders that do
    not sleep. At full speed a hand crosses this distance in a quarter of the horizon, with six new plans meanwhile."""
    rest_m_s: NonNegative = 0.01
    """Among several objects, an object at rest sleeps in a rollout until something touches it, which halves the time
    of pick-clutter (docs/research/speed.md). At rest means that no point of its rim moves faster than this; 0
    keeps all awake."""
    threads: Annotated[int, Field(ge=0, le=1024)] = 0
    """Number of threads; 0 uses every core."""
    rollouts: Literal["mujoco", "warp"] = "mujoco"
    """What computes the rollouts: MuJoCo on the CPU, or MuJoCo Warp on an NVIDIA GPU (extra `warp`)."""
    device: str = ""
    """Device of Warp, such as cuda:0 or cpu; empty takes the first GPU, or the CPU if there is none."""
    hand: HandCfg = field(default_factory=HandCfg)
    """The hand's apparent dynamics."""
    latency: str = "0"
    """Time that passes in the world while a plan is computed: measured (as long as it takes on this machine),
    SECONDS or fixed:SECONDS, or 0: the world stands still. With latency a plan starts from the state predicted for the
    moment at which it will be ready, and the hand follows the plan before until then."""


@dataclass(frozen=True)
class ControlSequences:
    """Hand targets of a batch of rollouts, one per control step."""

    position: Array
    """Position of the tool's target, Shape=(K, H, 3) m."""
    quaternion: Array
    """Orientation of the tool's target, Shape=(K, H, 4)."""
    opening: Array
    """Opening, Shape=(K, H) m."""
    stiffness: float
    """Stiffness of all rollouts, N/m."""


class PlanningWorld:
    """A simulation of the scene under believed parameters, in which control sequences are rolled out.

    The trial's sizes and shapes are known, its masses and frictions are replaced by `beliefs`: one for each object, or
    several sets of them, to compare. Costs read `start`, the first observation, as `_init_`.
    """

    def __init__(
        self,
        trial: Trial,
        beliefs: Mapping[str, PhysicalParameters] | Sequence[Mapping[str, PhysicalParameters]],
        start: Observation,
        cfg: PlanningCfg,
    ) -> None:
        self.cfg = cfg
        self._trial, self._start = _as_first_seen(trial, start), start
        self.edges = False
        """Whether the table has edges regardless of their distance."""
        self._substeps = whole_steps(cfg.step_s, cfg.physics_dt_s, "--cfg", "planning.physics_dt_s")
        self._rollouts: Rollouts | WarpRollouts = (
            Rollouts(cfg.threads) if cfg.rollouts == "mujoco" else WarpRollouts(cfg.device, cfg.threads)
        )
        self.schema = task_schema_of(trial.task)
        """The quantities that a cost can read here."""
        self.object_names = tuple(item.name for item in trial.task.objects)
        self.fixed_names = trial.task.things
        """The table and the fixtures."""
        self._corners = {name: trial.corners(name) for name in self.object_names}
        self.believe(beliefs)
        self._scratch = mujoco.MjData(self.models[0])

    def believe(self, beliefs: Mapping[str, PhysicalParameters] | Sequence[Mapping[str, PhysicalParameters]]) -> None:
        """Rebuild the models with new masses and frictions."""
        self.beliefs: list[Mapping[str, PhysicalParameters]] = (
            [beliefs] if isinstance(beliefs, Mapping) else list(beliefs)
        )
        self.models = self._build(endless=False)
        self._endless: list[mujoco.MjModel] = []
        self._fixed: dict[int, Mapping[str, Value]] = {}
        self._index = Index(self.models[0], self.object_names)
        self._last: tuple[Observation, Array] | None = None

    def _build(self, endless: bool) -> list[mujoco.MjModel]:
        models = [
            build_model(with_beliefs(self._trial, one), self.cfg.hand, self.cfg.physics_dt_s, endless)
            for one in self.beliefs
        ]
        if self._rollouts.can_sleep and len(self.object_names) > 1 and self.cfg.rest_m_s > 0:
            for model in models:
                model.opt.enableflags |= SLEEP
                model.opt.sleep_tolerance = self.cfg.rest_m_s
        return models

    def close(self) -> None:
        """Stop the rollout's threads."""
        self._rollouts.close()

    def rollout(
        self, now: Observation, controls: ControlSequences, step: int = 0, since: Observation | None = None
    ) -> tuple[Context, NDArray[np.bool_]]:
        """Roll out K sequences from the present state under each belief.

        The active stage began with `since`; None if it begins now. Returns the states after each control step, where K
        is beliefs x sequences in that order, and which rollouts are valid, Shape=(K,): diverged ones are not, and their
        states repeat the last valid one.
        """
        count, horizon = controls.opening.shape
        total = count * len(self.models)
        chosen = self.models
        if not self.edges and self._is_inland(now):
            self._endless = chosen = self._endless or self._build(endless=True)
        for model in chosen:
            set_stiffness(model, self.cfg.hand, controls.stiffness)
        initial = self._initial(now)
        control = np.zeros((len(self.models), count, horizon, self._substeps, self.models[0].nu + 7))
        control[..., 0] = control[..., 1] = controls.opening[..., None] / 2
        control[..., -7:-4] = controls.position[:, :, None]
        control[..., -4:] = controls.quaternion[:, :, None]
        rolled = self._rollouts.run(
            [RolloutStart.at(model, initial) for model in chosen],
            control.reshape(total, horizon * self._substeps, -1),
            CONTROL,
            self._substeps,
            partial(_repair_divergence, self._index.speeds, initial, self.cfg.step_s),
        )
        values = self._values(rolled.states, rolled.sensors, controls, now, step, since or now)
        return Context(values, (total, horizon)), rolled.sane

    def present(
        self, now: Observation, step: int = 0, opening_m: float | None = None, since: Observation | None = None
    ) -> Context:
        """Return the measured state as a batch of one; contacts are the first belief's after one still step.

        The active stage began with `since`; None if it begins now. By default the measured opening is the commanded
        one.
        """
        still = ControlSequences(
            now.tool.position[None, None],
            now.tool.quaternion[None, None],
            np.full((1, 1), now.opening_m if opening_m is None else opening_m),
            self.cfg.hand.stiffness_n_m,
        )
        context, _ = self.rollout(now, still, step, since)
        return context.first() if len(self.models) > 1 else context

    def placed(self, now: Observation) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """Return the model under the best belief, and its data with everything where it is measured."""
        model, data = self.models[0], self._scratch
        mujoco.mj_resetData(model, data)
        data.time = now.time_s
        put_state(model, data, now, self._trial)
        _shift_fingers(model, data)
        mujoco.mj_fwdPosition(model, data)
        return model, data

    def _is_inland(self, now: Observation) -> bool:
        """Check whether nothing will come near an edge of the table for a while."""
        table = self._trial.task.table
        half, center = np.asarray(table.size)[:2] / 2 - self.cfg.inland_m, np.asarray(table.center)
        points = [
            now.tool.position[None],
            *(body.position + rotate(body.quaternion, self._corners[name]) for name, body in now.objects.items()),
        ]
        return all(bool((np.abs(each[:, :2] - center) < half).all()) for each in points)

    def _initial(self, now: Observation) -> Array:
        """Return MuJoCo's full physics state at the start of rollouts, Shape=(S,)."""
        if self._last is not None and self._last[0] is now:
            return self._last[1]  # a plan needs it twice
        model, data = self.placed(now)
        state = np.zeros(mujoco.mj_stateSize(model, FULL))
        mujoco.mj_getState(model, data, state, FULL)
        self._last = now, state
        return state

    def _values(
        self, states: Array, sensors: Array, controls: ControlSequences, now: Observation, step: int, since: Observation
    ) -> Mapping[str, Value]:
        index, horizon = self._index, states.shape[1]
        qpos, qvel = states[..., 1 : 1 + index.nq], states[..., 1 + index.nq : 1 + index.nq + index.nv]

        def sensed(name: str, part: slice = slice(None)) -> Array:
            return np.asarray(sensors[..., index.sensor[name]][..., part])

        def touches(name: str) -> Array:
            return np.asarray((sensors[..., index.sensor[name].start] > 0).astype(float))

        def placed(name: str, local: Array) -> Array:
            if name not in index.pose:
                return np.asarray(sensed(pair(name, "pos")) + rotate(sensed(pair(name, "quat")), local))
            start = index.pose[name].start
            return np.asarray(qpos[..., start : start + 3] + rotate(qpos[..., start + 3 : start + 7], local))

        def spin(name: str) -> Array:
            start = index.pose[name].start  # a free joint stores angular velocity in body axes
            return rotate(qpos[..., start + 3 : start + 7], qvel[..., index.speed[name]][..., 3:])

        def stands(name: str) -> Array:
            joint, value = self._trial.task.object(name).joint, qpos[..., index.joint[name]]
            return np.asarray(np.degrees(value) if joint is not None and joint.kind == "hinge" else value)

        def wrung() -> Array:
            lever = sensed("hand_anything", PLACE) - sensed("ee_pos")
            return np.asarray(-sensed("hand_anything", TORQUE) - np.cross(lever, sensed("hand_anything", FORCE)))

        clock = (now.time_s + self.cfg.step_s * np.arange(1, horizon + 1))[None]
        makers: dict[str, Callable[[], Value] | Value] = {
            **{name: partial(sensed, name) for name in ("ee_pos", "ee_quat", "ee_vel", "ee_angvel")},
            "gripper_opening": lambda: qpos[..., index.left] + qpos[..., index.right],
            "gripper_target": lambda: np.tile(controls.opening, (len(self.models), 1)),
            "ee_force": lambda: -sensed("hand_anything", FORCE),
            "ee_torque": wrung,
            "time": clock,
            "stage_time": clock - since.time_s,
            "current_step": (step + np.arange(1.0, horizon + 1))[None],
            "last_action": lambda: _action(controls, len(self.models), self.cfg.step_s),
        }
        for name in self.object_names:
            makers[f"{name}_seen"] = np.full((1, 1), float(name not in now.unseen | now.lost))
            if name in now.unseen:
                makers[f"{name}_guessed"] = np.ones((1, 1))
            if name in index.pose:
                pose, speed = index.pose[name].start, index.speed[name].start
                makers[f"{name}_pos"] = qpos[..., pose : pose + 3]
                makers[f"{name}_quat"] = qpos[..., pose + 3 : pose + 7]
                makers[f"{name}_vel"] = qvel[..., speed : speed + 3]
                makers[f"{name}_angvel"] = partial(spin, name)
            else:
                makers |= {f"{name}_{kind}": partial(sensed, pair(name, kind)) for kind in MOTION}
                makers[f"{name}_joint"] = partial(stands, name)
            for side in ("left", "right"):
                makers[f"{name}_{side}_contact"] = partial(touches, pair(side, name))
            for point, local in self._trial.task.object(name).points.items():
                offset = np.asarray(local) * self._trial.objects[name].scale
                makers[f"{name}_{point}_pos"] = partial(placed, name, offset)
        for name in (*self.object_names, *self.fixed_names):
            makers[f"{name}_hand_contact"] = partial(touches, pair("hand", name))
            makers[f"{name}_palm_contact"] = partial(touches, pair("palm", name))
            makers[f"{name}_hand_force"] = partial(sensed, pair("hand", name), FORCE)
        for name, other in contact_pairs(self._trial):
            shared = pair(name, other) if pair(name, other) in index.sensor else pair(other, name)
            makers[f"{name}_{other}_contact"] = partial(touches, shared)
        total = len(states)
        if total not in self._fixed:
            fixed = constants(self._trial, self._start, self.beliefs, total)
            self._fixed[total] = {**clearances(self._trial), **fixed}
        return Lazy({**makers, **self._fixed[total], **stage_constants(since)})


def _as_first_seen(trial: Trial, start: Observation) -> Trial:
    """Place objects on joints where they were first seen: their axes follow from that."""
    seen = {
        item.name: dataclasses.replace(trial.objects[item.name], pose=start.objects[item.name])
        for item in trial.task.objects
        if item.joint is not None
    }
    return dataclasses.replace(trial, objects={**trial.objects, **seen})


def put_state(model: mujoco.MjModel, data: mujoco.MjData, now: Observation, trial: Trial) -> None:
    """Write a measured state into a model with the floating hand; joints of objects get the nearest position."""
    start = int(model.joint("hand_x").qposadr[0])
    data.qpos[start : start + 3] = now.tool.position
    data.qpos[start + 3 : start + 7] = now.tool.quaternion
    dof = int(model.joint("hand_x").dofadr[0])
    data.qvel[dof : dof + 3] = now.tool.velocity
    data.qvel[dof + 3 : dof + 6] = _own_axes(now.tool)
    for side in ("left", "right"):
        data.qpos[int(model.joint(f"{side}_slide").qposadr[0])] = now.opening_m / 2
    for name, body in now.objects.items():
        held = trial.task.object(name).joint
        if held is not None:
            own = model.joint(f"{name}_joint")
            data.qpos[own.qposadr[0]] = np.clip(trial.joint_position(name, body), *own.range)
            data.qvel[own.dofadr[0]] = joint_speed(held, trial.objects[name].pose, body)
            continue
        joint = model.joint(f"{name}_free")
        place, speed = int(joint.qposadr[0]), int(joint.dofadr[0])
        data.qpos[place : place + 3] = body.position
        data.qpos[place + 3 : place + 7] = body.quaternion
        data.qvel[speed : speed + 3] = body.velocity
        data.qvel[speed + 3 : speed + 6] = _own_axes(body)


def _shift_fingers(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Shift the pair of fingers out of a penetrated object by up to 1.5 cm, keeping the opening.

    Only the sum of the fingers' positions is measured. An object held off-centre would start deep inside one finger and
    be thrown out of the imagined grasp, so that no lift could be found.
    """
    mujoco.mj_fwdPosition(model, data)
    depth = {"left": 0.0, "right": 0.0}
    for contact in data.contact:
        bodies = [model.body(model.geom_bodyid[geom]).name for geom in contact.geom]
        for side, other in (bodies, bodies[::-1]):
            if side in depth and other not in ("world", "hand", "left", "right"):
                # The contact's x axis points from the first geom to the second: the direction that frees a second
                # finger.
                outward = contact.frame[:3] * (1.0 if side == bodies[1] else -1.0)
                along = data.joint(f"{side}_slide").xaxis @ outward
                if along > 0.7:
                    depth[side] = max(depth[side], -contact.dist / along)
    shift = np.clip((depth["left"] - depth["right"]) / (1.0 if min(depth.values()) == 0.0 else 2.0), -0.015, 0.015)
    data.joint("left_slide").qpos[0] += shift
    data.joint("right_slide").qpos[0] -= shift


def _own_axes(body: BodyState) -> Array:
    return rotate(body.quaternion * np.array([1.0, -1, -1, -1]), body.angular_velocity)


def _repair_divergence(
    speeds: NDArray[np.int_], initial: Array, step_s: float, states: Array, sensors: Array
) -> NDArray[np.bool_]:
    """Return which rollouts are valid, Shape=(K,); repeat the last valid state in the others, in place."""
    # MuJoCo resets a diverged state and its rollout then stands still: only its clock tells.
    clock = initial[0] + step_s * np.arange(1.0, states.shape[1] + 1)
    if (
        np.isfinite(states.sum())
        and np.isfinite(sensors.sum())
        and np.abs(states[..., 0] - clock).max() < 0.1 * step_s
        and max(float(np.abs(states[..., k]).max()) for k in speeds) <= SANE_SPEED_M_S
    ):
        return np.ones(len(states), dtype=bool)  # usually all are valid: a faster check
    bad: NDArray[np.bool_] = ~(np.abs(states[..., 0] - clock) < 0.1 * step_s)
    bad |= ~np.isfinite(states).all(axis=-1) | ~np.isfinite(sensors).all(axis=-1)
    bad |= np.asarray(np.abs(states[..., speeds]) > SANE_SPEED_M_S).any(axis=-1)
    sane: NDArray[np.bool_] = np.logical_not(bad.any(axis=1))
    for k in np.flatnonzero(~sane):
        first = int(np.argmax(bad[k]))
        states[k, first:] = states[k, first - 1] if first else np.nan_to_num(initial, posinf=0.0, neginf=0.0)
        sensors[k, first:] = sensors[k, first - 1] if first else 0.0
    return sane


def _action(controls: ControlSequences, repeats: int, step_s: float) -> Array:
    """Return the speeds of the commanded pose and opening, Shape=(K, H, 7)."""
    move = np.diff(controls.position, axis=1, prepend=controls.position[:, :1]) / step_s
    q = controls.quaternion
    before = np.concatenate([q[:, :1], q[:, :-1]], axis=1) * np.array([1.0, -1, -1, -1])
    turn = 2.0 * multiply(q, before)[..., 1:] / step_s
    grip = np.diff(controls.opening, axis=1, prepend=controls.opening[:, :1])[..., None] / step_s
    return np.tile(np.concatenate([move, turn, grip], axis=-1), (repeats, 1, 1))
