"""The limits of an arm: which of them a state violates, and which targets are within them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from coral.config import NonNegative, Positive, Signed
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, to_rotvec
from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.franka.arm import ArmState
from coral.contact.worlds.franka.arm_geometry import self_distance

JOINT_LOW = np.array([-2.7437, -1.7628, -2.8973, -3.0421, -2.8065, 0.5445, -2.8973])
JOINT_HIGH = np.array([2.7437, 1.7628, 2.8973, -0.1518, 2.8065, 3.7525, 2.8973])
"""Shape=(7,) rad: the narrower limit of Panda and FR3 (Franka Robotics, FCI documentation)."""
JOINT_SPEED = np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])
"""Shape=(7,) rad/s, the Panda's; the FR3's are higher away from the ends of its joints."""


@dataclass(frozen=True, kw_only=True)
class ArmLimitsCfg:
    """Limits of the arm. A state beyond one of them stops it."""

    joint_margin_rad: NonNegative = 0.05
    """Distance that each joint keeps from its end."""
    joint_speed_share: Positive = 0.8
    """Share of the joints' own speed limits."""
    tool_speed_m_s: Positive = 0.8
    """Speed of the tool. The planner's targets move with 0.5 m/s at most."""
    workspace_low_m: tuple[Signed, Signed, Signed] = (-0.3, -0.4, 0.004)
    workspace_high_m: tuple[Signed, Signed, Signed] = (0.35, 0.4, 0.5)
    """Corners of the tool's box, world frame; targets are clipped to it. The pads reach 8 mm below the tool, and the
    lower side is above the table by so much that they touch it gently at worst."""
    workspace_margin_m: NonNegative = 0.03
    """A tool farther than this outside of the box stops the arm."""
    self_distance_m: NonNegative = 0.01
    """Smallest distance between links."""
    push_n: Positive = 30.0
    """Limit on the pull of the impedance. Against a measured force above it the pull is reduced further."""
    turn_n_m: Positive = 5.0
    """Limit on the torque of the impedance. Damped critically, the hand then turns with 1.5 rad/s at most."""
    contact_force_n: Positive = 45.0
    """Contact force that slow contacts are not to exceed. A blow does: its first milliseconds precede any stop."""
    stop_share: Annotated[float, Field(gt=0, le=1)] = 0.8
    """Share of it at which the arm is stopped: until it rests a force that grows slowly goes on rising."""
    contact_torque_n_m: Positive = 12.0
    """A measured contact torque about the tool above it stops the arm."""


class Limits:
    """Checks states and bounds targets.

    Args:
        cfg: The limits.
        base_m: Shape=(3,), the arm's base in the world frame.
        lever_m2: Rotational stiffness (N m/rad) per translational stiffness (N/m).
    """

    def __init__(self, cfg: ArmLimitsCfg, base_m: Array, lever_m2: float) -> None:
        self.cfg, self._lever_m2 = cfg, lever_m2
        self._low = np.asarray(cfg.workspace_low_m, float) - base_m
        self._high = np.asarray(cfg.workspace_high_m, float) - base_m

    def violation(self, state: ArmState, wrench: Array) -> str:
        """Return which limit a state violates, in words with numbers; "" if it violates none.

        Args:
            state: The state, in the arm's base frame.
            wrench: Shape=(6,), the contact wrench without its bias.
        """
        cfg = self.cfg
        if not np.isfinite([*state.joints, *state.joint_speeds, *state.position, *state.twist, *wrench]).all():
            return "a measurement is not a finite number"
        room = np.minimum(state.joints - JOINT_LOW, JOINT_HIGH - state.joints)
        if room.min() < cfg.joint_margin_rad:
            return f"joint {int(room.argmin()) + 1} is {room.min():.3f} rad from its end"
        share = np.abs(state.joint_speeds) / JOINT_SPEED
        if share.max() > cfg.joint_speed_share:
            return f"joint {int(share.argmax()) + 1} moves with {share.max():.0%} of its speed limit"
        speed = float(np.linalg.norm(state.twist[:3]))
        if speed > cfg.tool_speed_m_s:
            return f"the tool moves with {speed:.2f} m/s"
        outside = float(np.maximum(self._low - state.position, state.position - self._high).max())
        if outside > cfg.workspace_margin_m:
            return f"the tool is {100 * outside:.1f} cm outside of its workspace"
        force, torque = (float(np.linalg.norm(part)) for part in (wrench[:3], wrench[3:]))
        if force > cfg.stop_share * cfg.contact_force_n:
            return f"a contact force of {force:.0f} N was measured"
        if torque > cfg.contact_torque_n_m:
            return f"a contact torque of {torque:.1f} N m was measured"
        gap = self_distance(state.joints)
        if gap < cfg.self_distance_m:
            return f"two links are {100 * gap:.1f} cm apart"
        return ""

    def bounded(self, target: HandTarget, state: ArmState, wrench: Array) -> HandTarget:
        """Bound a target: inside the workspace, and pulling no harder than allowed.

        Against a measured force F above `push_n` the pull's component into the contact is scaled by push_n / F.

        Args:
            target: The target in the arm's base frame. Its additional force is converted to a displacement.
            state: The present state.
            wrench: Shape=(6,), the contact wrench without its bias.
        """
        most = self.cfg.push_n / target.stiffness
        lead = np.clip(target.position, self._low, self._high) + target.force / target.stiffness - state.position
        felt = float(np.linalg.norm(wrench[:3]))
        if felt > self.cfg.push_n:
            push = -wrench[:3] / felt
            lead = lead - max(0.0, float(lead @ push)) * (1.0 - self.cfg.push_n / felt) * push
        length = float(np.linalg.norm(lead))
        if length > most:
            lead = lead * (most / length)
        turn = to_rotvec(multiply(target.quaternion, conjugate(state.quaternion)))
        angle, widest = float(np.linalg.norm(turn)), self.cfg.turn_n_m / (self._lever_m2 * target.stiffness)
        if angle > widest:
            turn = turn * (widest / angle)
        quaternion = multiply(from_rotvec(turn), state.quaternion)
        return replace(target, position=state.position + lead, quaternion=quaternion, force=np.zeros(3))
