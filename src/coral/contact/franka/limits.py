"""The limits of an arm: which of them a state violates, and which targets are within them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from coral.contact.control.hand_model import HandCfg
from coral.contact.franka.arm_geometry import self_distance
from coral.contact.franka.franky_arm import ArmState
from coral.contact.franka.hand_gaps import TOUCHING_M, Gap
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, to_rotvec
from coral.contact.scene.observation import Array, HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg

JOINT_LOW = np.array([-2.7437, -1.7628, -2.8973, -3.0421, -2.8065, 0.5445, -2.8973])
JOINT_HIGH = np.array([2.7437, 1.7628, 2.8973, -0.1518, 2.8065, 3.7525, 2.8973])
"""Shape=(7,) rad: the narrower limit of Panda and FR3 (Franka Robotics, FCI documentation)."""
JOINT_SPEED = np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])
"""Shape=(7,) rad/s, the Panda's; the FR3's are higher away from the ends of its joints."""
_PUSHED_N = (2.0, 8.0)
"""Forces between which a touched thing may be pushed faster and faster; noise and drift are below."""
_PROJECTIONS = 5
"""Rounds in which a lead is projected onto what all gaps allow."""


class Limits:
    """Checks states and bounds targets."""

    def __init__(self, arm: FrankaCfg) -> None:
        self.cfg, self._hand = arm.limits, HandCfg()
        self._low = np.asarray(self.cfg.workspace_low_m, float) - arm.base_m
        self._high = np.asarray(self.cfg.workspace_high_m, float) - arm.base_m

    def violation(self, state: ArmState, wrench: Array) -> str:
        """Return which limit a state violates, in words with numbers; "" if it violates none.

        The state is in the arm's base frame; `wrench`, Shape=(6,), is the contact wrench without its bias.
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

    @property
    def gap_m(self) -> float:
        """Return the width of the widest gap that slows the hand down."""
        return self.cfg.tool_speed_m_s * self.cfg.slow_down_s

    def bounded(
        self,
        target: HandTarget,
        state: ArmState,
        wrench: Array,
        gaps: Sequence[Gap] = (),
        pressing: Array | None = None,
    ) -> HandTarget:
        """Bound a target: inside the workspace, pulling no harder than allowed, and slowly towards what is near.

        Against a measured force F above `push_n` the pull's component into the contact is scaled by push_n / F.

        The target is in the arm's base frame; its additional force is converted to a displacement. `wrench`,
        Shape=(6,), is the contact wrench without its bias; `pressing`, Shape=(3,), the contact force without its blows:
        smoothed. By default it is that of `wrench`.
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
        angle, widest = float(np.linalg.norm(turn)), self.cfg.turn_n_m / (self._hand.lever_m2 * target.stiffness)
        if angle > widest:
            turn = turn * (widest / angle)
        pressing = wrench[:3] if pressing is None else pressing
        lead, turn = self._slowed(lead, turn, state, target.stiffness, pressing, gaps)
        quaternion = multiply(from_rotvec(turn), state.quaternion)
        return replace(target, position=state.position + lead, quaternion=quaternion, force=np.zeros(3))

    def _slowed(
        self, lead: Array, turn: Array, state: ArmState, stiffness: float, force: Array, gaps: Sequence[Gap]
    ) -> tuple[Array, Array]:
        """Reduce a lead (m) and a turn (rad) so far that the impedance closes no gap too fast.

        A pull p moves the damped hand with p / D; a hand that is faster or slower than allowed may be pulled less or
        more. Against a force that is felt across the gap it may pull that much more, so that a contact is pressed. What
        is felt to be touched may be pushed faster than it may be met.
        """
        cfg, hand = self.cfg, self._hand
        damping = 2.0 * np.sqrt(stiffness * hand.mass_kg)
        turning_stiffness = stiffness * hand.lever_m2
        spin = turn * turning_stiffness / (2.0 * np.sqrt(turning_stiffness * hand.inertia_kg_m2))
        felt = [max(0.0, -float(force @ gap.direction)) for gap in gaps]
        meeting = [cfg.touch_speed_m_s + gap.distance_m / cfg.slow_down_s for gap in gaps]
        allowed = [
            slow + max(0.0, cfg.push_speed_m_s - slow) * float(np.interp(against, _PUSHED_N, (0.0, 1.0)))
            if gap.distance_m < TOUCHING_M
            else slow
            for gap, against, slow in zip(gaps, felt, meeting, strict=True)
        ]
        turning = [float(gap.direction @ np.cross(spin, gap.lever_m)) for gap in gaps]
        share = min((most / by for most, by in zip(allowed, turning, strict=True) if by > most), default=1.0)
        most_n = []
        for gap, against, slow, most, by in zip(gaps, felt, meeting, allowed, turning, strict=True):
            speed = float(gap.direction @ (state.twist[:3] + np.cross(state.twist[3:], gap.lever_m)))
            correction = cfg.closing_gain * (max(0.0, slow - speed) - max(0.0, speed - most))
            most_n.append(damping * (most - max(0.0, share * by) + correction) + against)
        for _ in range(_PROJECTIONS if gaps else 0):
            for gap, pull_n in zip(gaps, most_n, strict=True):
                lead = lead - max(0.0, float(lead @ gap.direction) - pull_n / stiffness) * gap.direction
        return lead, share * turn
