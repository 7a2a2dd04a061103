"""The gap between two geoms, where MuJoCo's own answer can be trusted."""

from __future__ import annotations

import mujoco
import numpy as np

from coral.contact.scene.geometry import from_rotvec, rotation_of
from coral.contact.scene.observation import Array

_AGREE_M = 1e-6
_TURNS = [rotation_of(from_rotvec(turn * axis)) for turn in (1e-4, -1e-4, 1e-3, -1e-3) for axis in np.eye(3)]


def geom_gap(
    model: mujoco.MjModel, data: mujoco.MjData, one: int, other: int, within_m: float
) -> tuple[float, Array, Array]:
    """Return the signed distance (m) of two geoms, and the nearest points on each, Shape=(3,), world frame.

    Up to MuJoCo 3.10 `mj_geomDistance` answers 0 for one pair of separate boxes in 25 (measured; issue 3383 of MuJoCo).
    Its points contradict it then, and with one geom turned by 0.0001 rad it finds the distance.

    The geoms' poses are read from `data`. If they are farther apart than `within_m`, it is returned, with meaningless
    points.
    """
    ends, before = np.zeros(6), data.geom_xmat[one].copy()
    for turn in (None, *_TURNS):
        if turn is not None:
            data.geom_xmat[one] = (before.reshape(3, 3) @ turn).reshape(9)
        distance = float(mujoco.mj_geomDistance(model, data, one, other, within_m, ends))
        if distance >= within_m or abs(np.linalg.norm(ends[3:] - ends[:3]) - abs(distance)) < _AGREE_M:
            break
    data.geom_xmat[one] = before
    return distance, ends[:3].copy(), ends[3:].copy()
