"""Where the Panda's hand can be: inverse kinematics within joint limits, with no link touching anything.

Damped least squares from several starting postures (Buss 2004, "Introduction to inverse kinematics with Jacobian
transpose, pseudoinverse and damped least squares methods", section 6), drawn towards mid-range in the nullspace.
Collisions are MuJoCo's.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from coral.contact.scene.observation import Array
from coral.contact.worlds.panda.names import (
    FINGER_JOINTS,
    JOINTS,
    LEFT_BODIES,
    RIGHT_BODIES,
    ROBOT_PARTS,
    SITE,
    TOOL_IN_SITE,
    part_of,
)

POSTURES = (
    (0.0, -0.1, 0.0, -2.35, 0.0, 2.25, 0.785),
    (0.0, 0.6, 0.0, -1.9, 0.0, 2.5, 0.785),
    (0.6, 0.3, 0.4, -2.0, -0.8, 2.2, 1.6),
    (-0.6, 0.3, -0.4, -2.0, 0.8, 2.2, 0.0),
    (0.5, 0.9, 0.0, -1.9, 1.5, 1.6, -1.2),
    (-0.5, 0.9, 0.0, -1.9, -1.5, 1.6, 2.2),
    (1.2, 0.8, -1.2, -2.0, 1.0, 1.9, 0.6),
    (-1.2, 0.8, 1.2, -2.0, -1.0, 1.9, 0.6),
)


@dataclass(frozen=True, kw_only=True)
class ReachCfg:
    """Numerical settings of the search.

    Args:
        iterations: At most, from each posture.
        position_tolerance_m, angle_tolerance_rad: When a pose counts as met.
        centring: Pull towards mid-range in the nullspace.
        damping: Of the least squares.
        limit_margin_rad: Kept to every joint limit.
        clearance_m: Kept between the robot and everything else.
    """

    iterations: int = 60
    centring: float = 0.2
    position_tolerance_m: float = 1e-3
    angle_tolerance_rad: float = 1e-2
    damping: float = 0.1
    limit_margin_rad: float = 0.05
    clearance_m: float = 0.0


@dataclass(frozen=True)
class Posture:
    """How the arm reaches a tool pose.

    Args:
        joints: Shape=(7,) rad.
        limit_margin_rad: Distance of the nearest joint to its limit.
        manipulability: Smallest singular value of the translational Jacobian, m/rad.
    """

    joints: Array
    limit_margin_rad: float
    manipulability: float


class Reach:
    """Answers whether, and how, the hand can take a pose in a given scene.

    Args:
        model: Scene with the Panda, as compiled for the world.
        cfg: Numerical settings.
    """

    def __init__(self, model: mujoco.MjModel, cfg: ReachCfg | None = None) -> None:
        self.cfg = cfg or ReachCfg()
        self._model = model = copy.copy(model)
        self._data = mujoco.MjData(model)
        self._site = model.site(SITE).id
        self._qpos = np.array([model.joint(name).qposadr[0] for name in JOINTS])
        self._dofs = np.array([model.joint(name).dofadr[0] for name in JOINTS])
        self._fingers = np.array([model.joint(name).qposadr[0] for name in FINGER_JOINTS])
        self._range = np.array([model.joint(name).range for name in JOINTS])
        self._robot_geom = np.array([is_robot_geom(model, geom) for geom in range(model.ngeom)])
        fingers = {model.body(name).id for name in (*LEFT_BODIES, *RIGHT_BODIES)}
        self._finger_geom = np.isin(model.geom_bodyid, sorted(fingers))
        self._own_geom = np.array([part_of(model, geom) in ROBOT_PARTS for geom in range(model.ngeom)])
        model.geom_margin[self._robot_geom] += self.cfg.clearance_m
        movable = model.body_dofnum[model.body_rootid] > 0
        self._movable_geom = movable[model.geom_bodyid] & ~self._robot_geom

    def find(
        self,
        position: Array,
        rotation: Array,
        opening_m: float = 0.08,
        starts: Sequence[Sequence[float]] = POSTURES,
    ) -> Posture | None:
        """The first posture that takes the pose within limits and free of touch, or None.

        Args:
            position: Shape=(3,) m of the tool, world frame.
            rotation: Shape=(3, 3) of the tool.
            opening_m: Of the fingers.
            starts: Postures to begin from, in order of preference.
        """
        best = None
        for start in starts:
            joints = self._solve(np.array(start, dtype=float), position, rotation)
            if joints is None or self.touches(joints, opening_m):
                continue
            posture = self._judge(joints)
            if best is None or posture.limit_margin_rad > best.limit_margin_rad:
                best = posture
            if best.limit_margin_rad > 0.3:
                break
        return best

    def touches(self, joints: Array, opening_m: float = 0.08) -> bool:
        """Whether the arm, so bent, touches a fixture, the table or itself (movable objects are ignored)."""
        model, data = self._model, self._data
        data.qpos[self._qpos] = joints
        data.qpos[self._fingers] = (opening_m / 2, -opening_m / 2)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        geoms = data.contact.geom
        alone = self._own_geom[geoms].all(axis=1)  # its own links, foot and mount may come close to each other
        near = data.contact.dist < np.where(alone, 0.0, self.cfg.clearance_m)
        ours = self._robot_geom[geoms].any(axis=1) & ~self._movable_geom[geoms].any(axis=1)
        ours &= ~self._finger_geom[geoms].all(axis=1)  # closed fingers touch each other
        return bool((near & ours).any())

    def _solve(self, joints: Array, position: Array, rotation: Array) -> Array | None:
        model, data, cfg = self._model, self._data, self.cfg
        low, high = self._range[:, 0] + cfg.limit_margin_rad, self._range[:, 1] - cfg.limit_margin_rad
        middle = (low + high) / 2
        jacobian = np.zeros((6, model.nv))
        error = np.zeros(6)
        for _ in range(cfg.iterations):
            data.qpos[self._qpos] = joints
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            tool = data.site_xmat[self._site].reshape(3, 3) @ TOOL_IN_SITE
            error[:3] = position - data.site_xpos[self._site]
            error[3:] = rotation_vector(rotation @ tool.T)
            if (
                np.linalg.norm(error[:3]) < cfg.position_tolerance_m
                and np.linalg.norm(error[3:]) < cfg.angle_tolerance_rad
            ):
                return joints
            mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], self._site)
            arm = jacobian[:, self._dofs]
            size = min(1.0, float(np.linalg.norm(error)))  # less damped and less drawn to the middle as it gets there
            inverse = arm.T @ np.linalg.inv(arm @ arm.T + (cfg.damping * size + 1e-3) ** 2 * np.eye(6))
            step = inverse @ np.clip(error, -0.3, 0.3)
            step += (np.eye(7) - inverse @ arm) @ (cfg.centring * size * (middle - joints))
            joints = np.clip(joints + np.clip(step, -0.4, 0.4), low, high)
        return None

    def _judge(self, joints: Array) -> Posture:
        model, data = self._model, self._data
        data.qpos[self._qpos] = joints
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jacSite(model, data, jacobian, None, self._site)
        margin = float(np.min(np.minimum(joints - self._range[:, 0], self._range[:, 1] - joints)))
        return Posture(joints, margin, float(np.linalg.svd(jacobian[:, self._dofs], compute_uv=False)[-1]))


def rotation_vector(rotation: Array) -> Array:
    """Axis times angle of a rotation matrix. Shape=(3,), rad."""
    quaternion, vector = np.zeros(4), np.zeros(3)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    mujoco.mju_quat2Vel(vector, quaternion, 1.0)
    return vector


def tool_rotation(pointing: Sequence[float], opening: Sequence[float]) -> Array:
    """Rotation of a tool whose z points along `pointing` and whose fingers open along `opening`. Shape=(3, 3)."""
    z = np.asarray(pointing, dtype=float) / np.linalg.norm(pointing)
    y = np.asarray(opening, dtype=float) - np.dot(opening, z) * z
    y /= np.linalg.norm(y)
    return np.column_stack([np.cross(y, z), y, z])


def is_robot_geom(model: mujoco.MjModel, geom: int) -> bool:
    """Whether a geom belongs to the arm or the gripper (the mount and the foot do not count: they cannot move)."""
    body = model.geom_bodyid[geom]
    return bool(model.body_weldid[body] != 0) and model.body(body).name.startswith(("robot0_", "gripper0_"))
