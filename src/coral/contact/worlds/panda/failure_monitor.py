"""Detects states in which a simulated trial must end: divergence, an unreachable pose."""

from __future__ import annotations

import mujoco
import numpy as np

from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.panda.names import ROBOT_PARTS, part_of
from coral.contact.worlds.robot_world import WorldError

MAX_SPEED = 100.0
"""Limit on the speed of any joint or object, m/s or rad/s; beyond it the simulation has diverged."""
REACH_ERROR_M, REACH_ERROR_RAD, REACH_TIME_S = 0.03, 0.3, 1.0
"""A hand at rest this far from its target, without contact, for this time, cannot reach it."""
REST_M_S = 0.02
"""A hand slower than this is at rest."""


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
