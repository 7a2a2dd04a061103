"""The hand's true force on each object in every physics step: for the judge and for reports, never for decisions."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from coral.contact.scene.observation import HandForce
from coral.contact.scene.trial import Trial

_FOUND, _FORCE, _NET = 1, 2, 3
_PREFIX = "hand-force/"


def add_hand_force_sensors(spec: mujoco.MjSpec, hand: str, trial: Trial) -> None:
    """Add a contact sensor for each object: the net force of the hand's body and of all that it carries on it."""
    body = mujoco.mjtObj.mjOBJ_XBODY
    for name in trial.objects:
        sensor = spec.add_sensor(
            name=f"{_PREFIX}{name}", type=mujoco.mjtSensor.mjSENS_CONTACT, objtype=body, objname=hand
        )
        sensor.reftype, sensor.refname = body, name
        sensor.intprm[:3] = [_FOUND | _FORCE, _NET, 1]


class HandForces:
    """Collects the sensors' readings over a control step."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, trial: Trial) -> None:
        self._data = data
        self._adr = {name: int(model.sensor(f"{_PREFIX}{name}").adr[0]) for name in trial.objects}
        self._readings: dict[str, list[np.ndarray]] = {}
        self.begin()

    def begin(self) -> None:
        """Start a control step."""
        self._readings = {name: [] for name in self._adr}

    def add(self) -> None:
        """Add the readings of the last physics step."""
        for name, adr in self._adr.items():
            self._readings[name].append(self._data.sensordata[adr : adr + 4].copy())

    def read(self) -> Mapping[str, HandForce]:
        """Compute the forces since `begin`; without a physics step since, there are none."""
        found = {}
        for name, rows in self._readings.items():
            if rows:
                values = np.array(rows)
                forces = np.where(values[:, :1] > 0, values[:, 1:], 0.0)
                mean = forces.mean(axis=0) if (values[:, 0] > 0).any() else None
                found[name] = HandForce(mean, float(np.linalg.norm(forces, axis=1).max()))
        return found
