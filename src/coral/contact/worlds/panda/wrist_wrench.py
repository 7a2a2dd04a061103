"""The contact wrench on the hand, from the force/torque sensor at the wrist.

The sensor also measures the hand's weight and inertia. Both are subtracted as for a rigid body of known mass
(Newton-Euler), averaged over a control period, in which the mean acceleration is exactly the change of velocity.
"""

from __future__ import annotations

import mujoco
import numpy as np

from coral.contact.scene.geometry import cross
from coral.contact.scene.observation import Array
from coral.contact.worlds.panda.names import FORCE_SENSOR, HAND_BODY, SITE, TORQUE_SENSOR, WRIST_SITE


class WristWrench:
    """Averages the contact wrench over each control period; the hand's inertia is read at construction."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        self._force, self._torque = (
            slice(model.sensor(name).adr[0], model.sensor(name).adr[0] + 3) for name in (FORCE_SENSOR, TORQUE_SENSOR)
        )
        self._site, self._tool, self._body = model.site(WRIST_SITE).id, model.site(SITE).id, model.body(HAND_BODY).id
        parts = _subtree(model, self._body)
        self.mass = float(model.body_mass[parts].sum())
        rotation = data.xmat[self._body].reshape(3, 3)
        centre = model.body_mass[parts] @ data.xipos[parts] / self.mass
        self._centre = rotation.T @ (centre - data.xpos[self._body])
        inertia = np.zeros((3, 3))
        for part in parts:
            axes = data.ximat[part].reshape(3, 3)
            arm = data.xipos[part] - centre
            inertia += axes @ np.diag(model.body_inertia[part]) @ axes.T
            inertia += model.body_mass[part] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        self._inertia = rotation.T @ inertia @ rotation
        self._sum, self._count = np.zeros(6), 0
        self._before = np.zeros(6)

    def begin(self) -> None:
        """Start a control period: reset the sums, keep the velocity."""
        self._sum[:], self._count = 0.0, 0
        self._before = self._velocity()

    def add(self) -> None:
        """Add the sensor's reading of the last physics step."""
        rotation = self._data.site_xmat[self._site].reshape(3, 3)
        self._sum[:3] += rotation @ self._data.sensordata[self._force]
        self._sum[3:] += rotation @ self._data.sensordata[self._torque]
        self._count += 1

    def wrench(self) -> Array:
        """Compute the mean contact force (N) and torque (N m) on the hand since `begin`. Shape=(6,).

        At the tool, in world axes. Positions and velocities must be up to date.
        """
        data = self._data
        duration = self._count * self._model.opt.timestep
        mean = self._sum / self._count
        after = self._velocity()
        change = (after - self._before) / duration
        rotation = data.xmat[self._body].reshape(3, 3)
        centre = rotation @ self._centre
        inertia = rotation @ self._inertia @ rotation.T
        spin = 0.5 * (after[3:] + self._before[3:])
        needed = self.mass * (change[:3] - self._model.opt.gravity)
        force = needed - mean[:3]
        torque = cross(centre, needed) - mean[3:] + inertia @ change[3:] + cross(spin, inertia @ spin)
        lever = data.site_xpos[self._site] - data.site_xpos[self._tool]
        return np.concatenate([force, torque + cross(lever, force)])

    def _velocity(self) -> Array:
        """Return the velocity of the hand's centre of mass, and its angular velocity; world axes. Shape=(6,)."""
        model, data = self._model, self._data
        jacobian = np.zeros((6, model.nv))
        centre = data.xpos[self._body] + data.xmat[self._body].reshape(3, 3) @ self._centre
        mujoco.mj_jac(model, data, jacobian[:3], jacobian[3:], centre, self._body)
        velocity: Array = jacobian @ data.qvel
        return velocity


def _subtree(model: mujoco.MjModel, root: int) -> list[int]:
    found = [root]
    for body in range(root + 1, model.nbody):
        if int(model.body_parentid[body]) in found:
            found.append(body)
    return found
