"""The Panda world: a Franka Panda in robosuite whose hand is under Cartesian impedance control."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import Array, BodyState, HandTarget, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import Simulation, body_state
from coral.contact.worlds.hand_forces import HandForces, add_hand_force_sensors
from coral.contact.worlds.merged_contacts import merged_contacts
from coral.contact.worlds.panda.environment import START_RAD, make_environment
from coral.contact.worlds.panda.impedance import Impedance, ImpedanceCfg
from coral.contact.worlds.panda.names import (
    FINGER_JOINTS,
    HAND_BODY,
    JOINTS,
    PAD_OVERLAP_M,
    ROBOT_PARTS,
    SITE,
    TOOL_IN_SITE,
    part_of,
)
from coral.contact.worlds.panda.wrist_wrench import WristWrench
from coral.contact.worlds.robot_world import WorldError

START_OPENING_M = 0.08
SETTLE_S, SETTLE_STIFFNESS_N_M = 0.1, 600.0
"""Time for the objects to come to rest before the clock starts, and stiffness of the hand during it."""
MAX_SPEED = 100.0
"""Limit on the speed of any joint or object, m/s or rad/s; beyond it the simulation has diverged."""
REACH_ERROR_M, REACH_ERROR_RAD, REACH_TIME_S = 0.03, 0.3, 1.0
"""A hand at rest this far from its target, without contact, for this time, cannot reach it."""
REST_M_S = 0.02
"""A hand slower than this is at rest."""


class PandaWorld:
    """Simulates a trial with the Panda; each target lasts `period_s` (s).

    Raises:
        RunError: robosuite is not installed.
    """

    name = "panda"

    def __init__(self, trial: Trial, period_s: float = 0.02) -> None:
        self.control_period_s = period_s
        self._trial = trial
        self._env = make_environment(lambda spec: _add_trial(spec, trial), period_s, self._before_physics_step)
        self.model: mujoco.MjModel = self._env.sim.model._model
        self.data: mujoco.MjData = self._env.sim.data._data
        self.simulation = Simulation(self.model, self.data)
        model = self.model
        self._site = model.site(SITE).id
        self._arm = np.array([model.joint(name).qposadr[0] for name in JOINTS])
        self._fingers = np.array([model.joint(name).qposadr[0] for name in FINGER_JOINTS])
        self._objects = {name: model.body(name).id for name in trial.objects}
        self._place_robot()
        self._impedance = Impedance(model, self.data, ImpedanceCfg(), np.array(START_RAD))
        self._wrist = WristWrench(model, self.data)
        self._forces = HandForces(model, self.data, trial)
        self._watch = FailureMonitor(model)
        self._start = self._settle()

    def reset(self) -> Observation:
        """See `RobotWorld.reset`."""
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, self._start, mujoco.mjtState.mjSTATE_INTEGRATION)
        self.data.time = 0.0
        mujoco.mj_forward(self.model, self.data)
        self._watch.reset()
        self._forces.begin()
        return self._observe(np.zeros(6))

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`.

        Raises:
            ValueError: The target is not finite, or its stiffness is not positive.
        """
        numbers = (*target.position, *target.quaternion, *target.force, target.opening_m, target.stiffness)
        if not np.isfinite(numbers).all() or target.stiffness <= 0:
            raise ValueError(f"no pose to pull the hand to: {target}")
        self._advance(target)
        self._watch.check(self.data, self._impedance.error(target), target)
        return self._observe(self._wrist.wrench())

    def truth(self) -> Truth:
        """See `EvaluationWorld.truth`."""
        objects = {name: self._body(name) for name in self._objects}
        contacts = merged_contacts(self.model, self.data, part_of)
        return Truth(float(self.data.time), self._tool(), self._opening(), objects, contacts, self._forces.read())

    def stop(self) -> None:
        """See `RobotWorld.stop`; a simulation stands still between steps."""

    def close(self) -> None:
        """See `RobotWorld.close`."""
        self._env.close()

    def _place_robot(self) -> None:
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._arm] = START_RAD
        half = (START_OPENING_M + PAD_OVERLAP_M) / 2
        low, high = self.model.joint(FINGER_JOINTS[0]).range
        half = min(max(half, low), high)
        self.data.qpos[self._fingers] = (half, -half)
        mujoco.mj_forward(self.model, self.data)

    def _settle(self) -> Array:
        tool = self._tool()
        hold = HandTarget(tool.position, tool.quaternion, START_OPENING_M, SETTLE_STIFFNESS_N_M)
        for _ in range(round(SETTLE_S / self.control_period_s)):
            self._advance(hold)
        flag = mujoco.mjtState.mjSTATE_INTEGRATION
        state = np.zeros(mujoco.mj_stateSize(self.model, flag))
        mujoco.mj_getState(self.model, self.data, state, flag)
        return state

    def _advance(self, target: HandTarget) -> None:
        self._impedance.aim(target)
        self._wrist.begin()
        self._forces.begin()
        self._first = True
        self._env.step(target)
        self._wrist.add()
        self._forces.add()
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def _before_physics_step(self, action: Any) -> None:
        if self._first:
            self._first = False
        else:
            self._wrist.add()
            self._forces.add()
        self._impedance.act()

    def _observe(self, wrench: Array) -> Observation:
        objects = {name: self._body(name) for name in self._objects}
        return Observation(float(self.data.time), self._tool(), self._opening(), wrench, objects)

    def _opening(self) -> float:
        left, right = self.data.qpos[self._fingers]
        return float(left - right - PAD_OVERLAP_M)

    def _tool(self) -> BodyState:
        jacobian = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], self._site)
        velocity = jacobian @ self.data.qvel
        rotation = self.data.site_xmat[self._site].reshape(3, 3) @ TOOL_IN_SITE
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, rotation.reshape(-1))
        return BodyState(self.data.site_xpos[self._site].copy(), quaternion, velocity[:3], velocity[3:])

    def _body(self, name: str) -> BodyState:
        if self._trial.task.object(name).joint is not None:
            return body_state(self.model, self.data, name)
        body = self._objects[name]
        dof = int(self.model.body_dofadr[body])
        quaternion: Array = self.data.xquat[body].copy()
        spin = self.data.xmat[body].reshape(3, 3) @ self.data.qvel[dof + 3 : dof + 6]
        return BodyState(self.data.xpos[body].copy(), quaternion, self.data.qvel[dof : dof + 3].copy(), spin)


def _add_trial(spec: mujoco.MjSpec, trial: Trial) -> None:
    add_scene(spec, trial)
    add_hand_force_sensors(spec, HAND_BODY, trial)


class FailureMonitor:
    """Checks the state after every control period; the judge sees what goes through the table."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._robot = np.array([part_of(model, geom) in ROBOT_PARTS for geom in range(model.ngeom)])
        self.reset()

    def reset(self) -> None:
        """Start an episode."""
        self._stuck_since: float | None = None
        self._place = np.zeros(3)

    def check(self, data: mujoco.MjData, error: Array, target: HandTarget) -> None:
        """Check the state, positions up to date, after a control period; `error`, Shape=(6,), is from tool to target.

        Raises:
            WorldError: "diverged" or "unreachable".
        """
        speed = float(np.abs(data.qvel).max())
        if not (np.isfinite(speed) and np.isfinite(data.qpos).all()) or speed > MAX_SPEED:
            raise WorldError("diverged", f"the simulation diverged at {data.time:.2f} s (speed {speed:.3g})")
        self._check_reach(data, error, target)

    def _check_reach(self, data: mujoco.MjData, error: Array, target: HandTarget) -> None:
        away = error[:3] + target.force / target.stiffness
        far = float(np.linalg.norm(away)) > REACH_ERROR_M or float(np.linalg.norm(error[3:])) > REACH_ERROR_RAD
        tool = target.position - error[:3]
        rests = float(np.linalg.norm(tool - self._place)) < REST_M_S * REACH_TIME_S
        ours = self._robot[data.contact.geom]
        touches = bool((ours.any(axis=1) & ~ours.all(axis=1)).any())
        if not far or touches or not rests or self._stuck_since is None:
            self._stuck_since = data.time if far and not touches else None
            self._place = tool
        elif data.time - self._stuck_since > REACH_TIME_S:
            raise WorldError(
                "unreachable",
                f"the arm cannot bring its hand to {np.round(target.position, 3).tolist()} m: it rests "
                f"{np.linalg.norm(away):.3f} m and {np.linalg.norm(error[3:]):.2f} rad away, touching nothing",
            )
