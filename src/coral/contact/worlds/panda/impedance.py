"""Cartesian impedance control: the arm behaves like a spring and damper between the tool and its target.

    tau = J^T (K e - D v + f) + N tau_posture + c(q, qd) + g(q)              Hogan (1985), "Impedance control", part II
    N   = I - J^T Lambda J M^-1,  Lambda = (J M^-1 J^T)^-1                   Khatib (1987), operational space
    D   = zeta (sqrt(Lambda) sqrt(K) + sqrt(K) sqrt(Lambda))                 Albu-Schaeffer et al. (2003), translation
                                                                             and rotation each by itself

Inertia is not shaped, which would require the contact force. At rest the environment therefore feels exactly K; in
motion it also feels the arm's own effective mass on that spring.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.panda.names import ARM_ACTUATORS, FINGER_ACTUATORS, JOINTS, PAD_OVERLAP_M, SITE, TOOL_IN_SITE


@dataclass(frozen=True, kw_only=True)
class ImpedanceCfg:
    """Gains besides the commanded stiffness."""

    lever_m2: float = 0.05
    """Rotational stiffness (N m/rad) per translational stiffness (N/m), the same as for the planner's hand."""
    damping_ratio: float = 1.0
    """Damping ratio; 1 is critical."""
    max_force_n: float = 60.0
    max_torque_nm: float = 10.0
    """Limits on the spring force and torque, at any distance from the target."""
    posture_stiffness: float = 10.0
    """Stiffness towards the reset posture in the nullspace, N m/rad."""
    limit_margin_rad: float = 0.2
    limit_stiffness: float = 60.0
    """Within `limit_margin_rad` of a joint's limit, a spring (N m/rad) in the nullspace pushes back."""
    max_effective_mass: float = 30.0
    """Limit on the effective mass, kg; bounds the damping near singular postures."""


class Impedance:
    """Computes torques that make the tool obey Lambda a = K e - D v + f + f_ext, and moves the fingers.

    Lambda is the arm's effective mass at the hand, e the error to the target, f the commanded force and f_ext the
    contact force. `aim` sets K and D for a control period, `act` writes the torques at every physics step. The
    nullspace is pulled to `posture`, Shape=(7,) rad.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, cfg: ImpedanceCfg, posture: Array) -> None:
        self.cfg, self._model, self._data, self._posture = cfg, model, data, posture
        self._site = model.site(SITE).id
        self._dofs = np.array([model.joint(name).dofadr[0] for name in JOINTS])
        self._qpos = np.array([model.joint(name).qposadr[0] for name in JOINTS])
        self._arm = np.array([model.actuator(name).id for name in ARM_ACTUATORS])
        self._fingers = np.array([model.actuator(name).id for name in FINGER_ACTUATORS])
        limits = np.array([model.joint(name).range for name in JOINTS])
        self._low, self._high = limits[:, 0] + cfg.limit_margin_rad, limits[:, 1] - cfg.limit_margin_rad
        self._max_torque = model.actuator_ctrlrange[self._arm, 1]
        self._jacobian = np.zeros((6, model.nv))
        self._mass = np.zeros((model.nv, model.nv))
        self._stiffness = np.zeros(6)
        self._damping = np.zeros((6, 6))
        self._nullspace = np.zeros((7, 7))
        self._wanted = np.eye(3)
        self._quaternion, self._vector = np.zeros(4), np.zeros(3)
        self._target: HandTarget | None = None

    def aim(self, target: HandTarget) -> None:
        """Start a control period: compute the gains for this target at the present posture.

        Positions must be up to date.
        """
        model, data, cfg = self._model, self._data, self.cfg
        self._target = target
        self._stiffness[:3], self._stiffness[3:] = target.stiffness, cfg.lever_m2 * target.stiffness
        mujoco.mju_quat2Mat(self._wanted.reshape(-1), np.asarray(target.quaternion, dtype=float))
        mujoco.mj_jacSite(model, data, self._jacobian[:3], self._jacobian[3:], self._site)
        mujoco.mj_fullM(model, self._mass, data.qM)
        jacobian = self._jacobian[:, self._dofs]
        mobility = np.linalg.solve(self._mass[np.ix_(self._dofs, self._dofs)], jacobian.T)  # M^-1 J^T
        inverse = jacobian @ mobility
        for block in (slice(0, 3), slice(3, 6)):
            values, vectors = np.linalg.eigh(inverse[block, block])
            root = (vectors / np.sqrt(np.maximum(values, 1.0 / cfg.max_effective_mass))) @ vectors.T
            self._damping[block, block] = 2.0 * cfg.damping_ratio * np.sqrt(self._stiffness[block][0]) * root
        weight = np.linalg.inv(inverse + 1e-4 * np.eye(6))
        self._nullspace = np.eye(7) - jacobian.T @ weight @ mobility.T

    def act(self) -> None:
        """Write the torques of this physics step; call after `mj_step1`."""
        model, data, cfg, target = self._model, self._data, self.cfg, self._target
        if target is None:
            raise RuntimeError("aim before acting")
        mujoco.mj_jacSite(model, data, self._jacobian[:3], self._jacobian[3:], self._site)
        jacobian = self._jacobian[:, self._dofs]
        speed = data.qvel[self._dofs]
        spring = self._stiffness * self.error(target)
        spring[:3] += target.force
        for part, most in ((spring[:3], cfg.max_force_n), (spring[3:], cfg.max_torque_nm)):
            size = float(np.sqrt(part @ part))
            if size > most:
                part *= most / size
        wrench = spring - self._damping @ (jacobian @ speed)
        joints = data.qpos[self._qpos]
        inside = np.minimum(np.maximum(joints, self._low), self._high)
        posture = cfg.posture_stiffness * (self._posture - joints) + cfg.limit_stiffness * (inside - joints)
        posture -= 2.0 * np.sqrt(cfg.posture_stiffness) * speed
        torque = jacobian.T @ wrench + self._nullspace @ posture + data.qfrc_bias[self._dofs]
        data.ctrl[self._arm] = np.minimum(np.maximum(torque, -self._max_torque), self._max_torque)
        half = (target.opening_m + PAD_OVERLAP_M) / 2
        data.ctrl[self._fingers] = (half, -half)

    def error(self, target: HandTarget) -> Array:
        """Compute the error from the tool to its target: metres, and radians about world axes. Shape=(6,)."""
        error = np.empty(6)
        error[:3] = target.position - self._data.site_xpos[self._site]
        tool = self._data.site_xmat[self._site].reshape(3, 3) @ TOOL_IN_SITE
        mujoco.mju_mat2Quat(self._quaternion, (self._wanted @ tool.T).reshape(-1))
        mujoco.mju_quat2Vel(self._vector, self._quaternion, 1.0)
        error[3:] = self._vector
        return error
