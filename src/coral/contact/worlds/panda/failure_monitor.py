"""Detects states in which a simulated trial must end: divergence, tunnelling, an unreachable pose."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.evaluation_world import WorldError
from coral.contact.worlds.panda.names import ROBOT_PARTS, part_of


@dataclass(frozen=True, kw_only=True)
class FailureMonitorCfg:
    """Limits."""

    max_speed: float = 100.0
    """Limit on the speed of any joint or object, m/s or rad/s; beyond it the simulation has diverged."""
    sunk_m: float = 0.01
    """An object whose centre of mass is farther below the table's top than this has passed through it."""
    reach_error_m: float = 0.03
    reach_error_rad: float = 0.3
    """A hand at rest this far from its target, without contact, for `reach_time_s`, cannot reach it."""
    reach_time_s: float = 1.0
    rest_m_s: float = 0.02
    """A hand slower than this is at rest."""


class FailureMonitor:
    """Checks the state after every control period.

    Args:
        model: Model of the simulation.
        cfg: Limits.
        objects: Bodies of the movable objects.
    """

    def __init__(self, model: mujoco.MjModel, cfg: FailureMonitorCfg, objects: tuple[int, ...]) -> None:
        self.cfg, self._model, self._objects = cfg, model, objects
        self._robot = np.array([part_of(model, geom) in ROBOT_PARTS for geom in range(model.ngeom)])
        self._table = model.geom("table").id
        self._above: dict[int, bool] = {}
        self._stuck_since: float | None = None
        self._place = np.zeros(3)

    def reset(self, data: mujoco.MjData) -> None:
        """Start an episode."""
        self._stuck_since = None
        self._above = {body: self._over_table(data, body) and not self._is_sunk(data, body) for body in self._objects}

    def check(self, data: mujoco.MjData, error: Array, target: HandTarget) -> None:
        """Check the state after a control period.

        Args:
            data: The state, positions up to date.
            error: Shape=(6,) from the tool to the target.
            target: The target of that period.

        Raises:
            WorldError: "diverged", "tunnelling" or "unreachable".
        """
        self._check_finite(data)
        for body in self._objects:
            over, sunk = self._over_table(data, body), self._is_sunk(data, body)
            if self._above[body] and over and sunk:
                name = self._model.body(body).name
                raise WorldError("tunnelling", f"{name} went through the table at {data.time:.2f} s")
            self._above[body] = over and not sunk
        self._check_reach(data, error, target)

    def _check_finite(self, data: mujoco.MjData) -> None:
        speed = float(np.abs(data.qvel).max())
        if not (np.isfinite(speed) and np.isfinite(data.qpos).all()) or speed > self.cfg.max_speed:
            raise WorldError("diverged", f"the simulation diverged at {data.time:.2f} s (speed {speed:.3g})")

    def _over_table(self, data: mujoco.MjData, body: int) -> bool:
        inside = np.abs(data.xipos[body] - data.geom_xpos[self._table]) < self._model.geom_size[self._table]
        return bool(inside[:2].all())

    def _is_sunk(self, data: mujoco.MjData, body: int) -> bool:
        return bool(data.xipos[body, 2] < -self.cfg.sunk_m)

    def _check_reach(self, data: mujoco.MjData, error: Array, target: HandTarget) -> None:
        cfg = self.cfg
        away = error[:3] + target.force / target.stiffness
        far = float(np.linalg.norm(away)) > cfg.reach_error_m or float(np.linalg.norm(error[3:])) > cfg.reach_error_rad
        tool = target.position - error[:3]
        rests = float(np.linalg.norm(tool - self._place)) < cfg.rest_m_s * cfg.reach_time_s
        ours = self._robot[data.contact.geom]
        touches = bool((ours.any(axis=1) & ~ours.all(axis=1)).any())
        if not far or touches or not rests or self._stuck_since is None:
            self._stuck_since = data.time if far and not touches else None
            self._place = tool
        elif data.time - self._stuck_since > cfg.reach_time_s:
            raise WorldError(
                "unreachable",
                f"the arm cannot bring its hand to {np.round(target.position, 3).tolist()} m: it rests "
                f"{np.linalg.norm(away):.3f} m and {np.linalg.norm(error[3:]):.2f} rad away, touching nothing",
            )
