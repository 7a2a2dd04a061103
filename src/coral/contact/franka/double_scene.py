"""A trial's table and objects beside the simulated arm of franky-sim, with the contact forces that it leaves out."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping

import mujoco
import numpy as np

from coral.contact.control.hand_model import FLANGE_TO_TOOL_M
from coral.contact.scene.mujoco_scene import FINGER_FRICTION, FINGER_PRIORITY, ROLLING, TORSION, add_scene
from coral.contact.scene.observation import Array, BodyState, HandForce, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import body_state
from coral.contact.worlds.merged_contacts import merged_contacts

HAND, LEFT, RIGHT = "robot0_hand", "robot0_left_finger", "robot0_right_finger"
_NAMES = {HAND: "hand", LEFT: "left", RIGHT: "right"}
_OURS = ("hand", "left", "right")


def scene_elements(trial: Trial) -> Mapping[str, list[ET.Element]]:
    """Return a trial's MJCF elements by section: worldbody, asset, contact."""
    spec = mujoco.MjSpec()
    add_scene(spec, trial)
    spec.compile()
    root = ET.fromstring(spec.to_xml())
    found = {section: list(root.find(section) or ()) for section in ("worldbody", "asset", "contact")}
    for child in found["worldbody"]:  # its defaults would be lost with the sections that are left out
        child.attrib.pop("childclass", None)
    return found


def make_rubber(model: mujoco.MjModel) -> None:
    """Give the finger pads the friction that the planner assumes, and contacts the hand world's cones."""
    for geom in range(model.ngeom):
        if model.body(int(model.geom_bodyid[geom])).name in (LEFT, RIGHT):
            model.geom_priority[geom] = FINGER_PRIORITY
            model.geom_friction[geom] = [FINGER_FRICTION, TORSION, ROLLING]
            model.geom_condim[geom] = 4
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 10


def part_of(model: mujoco.MjModel, geom: int) -> str:
    """Return a geom's name for the judge: "left", "right", "hand", "robot", an object or a fixture."""
    body = int(model.geom_bodyid[geom])
    name = str(model.body(body).name)
    if body == 0:
        return str(model.geom(geom).name)
    return _NAMES.get(name, "robot" if name.startswith("robot0_") else name)


class DoubleScene:
    """Reads contacts and poses of the simulation."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, trial: Trial) -> None:
        self._model, self._data = model, data
        self._objects = tuple(trial.objects)
        names = [part_of(model, geom) for geom in range(model.ngeom)]
        self._is_ours = np.array([name in _OURS for name in names])
        self._object_of = [name if name in self._objects else "" for name in names]
        self._hand, self._contact = model.body(HAND).id, np.zeros(6)
        self._sums = {name: np.zeros(3) for name in self._objects}
        self._touched = dict.fromkeys(self._objects, False)
        self._peaks = dict.fromkeys(self._objects, 0.0)
        self._steps = 0

    def measure(self) -> Array:
        """Take in the contacts of a physics step: the wrench of the surroundings on hand and fingers.

        Shape=(6,), force and torque about the tool, world axes.
        """
        data, wrench = self._data, np.zeros(6)
        on: dict[str, Array] = {}
        pairs = data.contact.geom
        ours = self._is_ours[pairs] if data.ncon else np.zeros((0, 2), bool)
        tool = self.tool_m()
        for k in np.flatnonzero(ours[:, 0] != ours[:, 1]):
            contact = data.contact[k]
            if contact.efc_address < 0:
                continue
            mujoco.mj_contactForce(self._model, data, k, self._contact)
            # The contact frame's x axis points from the first geom to the second: this is the force on the second.
            force = contact.frame.reshape(3, 3).T @ self._contact[:3]
            if ours[k, 0]:
                force = -force
            wrench[:3] += force
            (ax, ay, az), (fx, fy, fz) = contact.pos - tool, force
            wrench[3:] += (ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx)
            other = self._object_of[pairs[k, 1] if ours[k, 0] else pairs[k, 0]]
            if other:
                on[other] = on.get(other, 0.0) - force
        for name, force in on.items():
            self._sums[name] += force
            self._touched[name] = True
            self._peaks[name] = max(self._peaks[name], float(np.linalg.norm(force)))
        self._steps += 1
        return wrench

    def tool_m(self) -> Array:
        """Return the tool's position in the world frame, Shape=(3,) m."""
        data, hand = self._data, self._hand
        return np.asarray(data.xpos[hand] + FLANGE_TO_TOOL_M * data.xmat[hand][2::3])

    def truth(self, time_s: float, tool: BodyState, opening_m: float) -> Truth:
        """Return the true state; forces are those since the last call."""
        forces = {
            name: HandForce(self._sums[name] / max(self._steps, 1) if self._touched[name] else None, self._peaks[name])
            for name in self._objects
        }
        for name in self._objects:
            self._sums[name], self._touched[name], self._peaks[name] = np.zeros(3), False, 0.0
        self._steps = 0
        contacts = merged_contacts(self._model, self._data, part_of)
        return Truth(time_s, tool, opening_m, self.poses(), contacts, forces)

    def poses(self) -> dict[str, BodyState]:
        """Return the true poses and velocities of the objects."""
        return {name: body_state(self._model, self._data, name) for name in self._objects}
