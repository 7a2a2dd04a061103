"""The light evaluation world: a free-flying hand in a finer simulation than the planner's; it needs no robosuite.

It differs from the planning world in the parameters that the planner cannot know (true masses and frictions) and in the
physics: 2 ms steps, elliptic cones, contacts that resist twisting.
"""

from __future__ import annotations

import mujoco
import numpy as np

from coral.config import whole_steps
from coral.contact.control.hand_model import HandCfg, add_hand, set_stiffness
from coral.contact.control.planning_world import put_state
from coral.contact.scene.geometry import rotate
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import BodyState, HandTarget, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import Simulation, body_state
from coral.contact.worlds.hand_forces import HandForces, add_hand_force_sensors
from coral.contact.worlds.merged_contacts import merged_contacts
from coral.contact.worlds.robot_world import WorldError

PHYSICS_DT_S = 0.002
START_M = (-0.1, 0.0, 0.25)
"""Start position of the tool."""
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Orientation of the tool: pointing down, opening along the world's y."""


class HandWorld:
    """Simulates a trial with the free-flying hand; each target lasts `period_s` (s)."""

    name = "hand"

    def __init__(self, trial: Trial, period_s: float = 0.02) -> None:
        self._trial, self._hand = trial, HandCfg()
        self.control_period_s = period_s
        spec = mujoco.MjSpec()
        spec.option.timestep = PHYSICS_DT_S
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.impratio = 10
        add_scene(spec, trial)
        add_hand(spec, self._hand)
        add_hand_force_sensors(spec, "hand", trial)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.simulation = Simulation(self.model, self.data)
        self._substeps = whole_steps(period_s, PHYSICS_DT_S, "hand", "physics_dt_s")
        self._stiffness = 0.0
        self._forces = HandForces(self.model, self.data, trial)

    def reset(self) -> Observation:
        """See `RobotWorld.reset`."""
        mujoco.mj_resetData(self.model, self.data)
        start = BodyState(np.asarray(START_M, dtype=float), DOWN)
        objects = {name: item.pose for name, item in self._trial.objects.items()}
        put_state(self.model, self.data, Observation(0.0, start, 0.08, np.zeros(6), objects), self._trial)
        self._pull(HandTarget(start.position, start.quaternion, 0.08, self._hand.stiffness_n_m))
        mujoco.mj_forward(self.model, self.data)
        self._forces.begin()
        return self._observe()

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`."""
        self._pull(target)
        self._forces.begin()
        for _ in range(self._substeps):
            mujoco.mj_step(self.model, self.data)
            self._forces.add()
        bad = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
        if not np.isfinite(self.data.qvel).all() or any(self.data.warning[int(kind)].number for kind in bad):
            raise WorldError("diverged", f"the simulation diverged at {self.data.time:.2f} s")
        mujoco.mj_forward(self.model, self.data)
        return self._observe()

    def truth(self) -> Truth:
        """See `EvaluationWorld.truth`."""
        seen = self._observe()
        contacts = merged_contacts(self.model, self.data, part_of)
        return Truth(seen.time_s, seen.tool, seen.opening_m, seen.objects, contacts, self._forces.read())

    def stop(self) -> None:
        """See `RobotWorld.stop`; a simulation stands still between steps."""

    def close(self) -> None:
        """See `RobotWorld.close`."""

    def _pull(self, target: HandTarget) -> None:
        model, data = self.model, self.data
        if target.stiffness != self._stiffness:
            set_stiffness(model, self._hand, target.stiffness)
            self._stiffness = target.stiffness
        data.mocap_pos[0], data.mocap_quat[0] = target.position, target.quaternion
        data.ctrl[:2] = target.opening_m / 2
        # The hand's actuators take a displacement, in the target's axes.
        own = target.quaternion * np.array([1.0, -1, -1, -1])
        data.ctrl[2:5] = rotate(own, target.force) / target.stiffness

    def _observe(self) -> Observation:
        model, data = self.model, self.data
        opening = float(sum(data.joint(f"{side}_slide").qpos[0] for side in ("left", "right")))
        objects = {name: body_state(model, data, name) for name in self._trial.objects}
        wrench = np.zeros(6)
        tool = data.body("hand").xpos
        for contact in merged_contacts(model, data, part_of):
            for ours, sign in ((contact.first, -1.0), (contact.second, 1.0)):
                if ours in ("hand", "left", "right"):
                    wrench[:3] += sign * contact.force
                    wrench[3:] += sign * np.cross(contact.point - tool, contact.force)
        return Observation(float(data.time), body_state(model, data, "hand"), opening, wrench, objects)


def part_of(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name for the judge."""
    body = int(model.geom_bodyid[geom])
    return str(model.geom(geom).name if body == 0 else model.body(body).name)
