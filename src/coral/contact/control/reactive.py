"""The reactive augmentation of the planned action (Eq. 7): nu = u + K_f (x_des - x_measured), on pose and wrench."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coral.config import NonNegative, Positive
from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, to_rotvec
from coral.contact.scene.observation import Array, HandTarget, Observation


@dataclass(frozen=True, kw_only=True)
class ReactiveCfg:
    """The feedback and the limits.

    Every plan begins at the measured state, so that x_des - x_measured is only what went otherwise than rehearsed
    during one control step. It is therefore summed with a leak: what is fed back is the error of the last `memory_s`,
    as it would be had the plan not been renewed.
    """

    enabled: bool = True
    """Whether K_f is anything but zero; the limits hold in any case."""
    pose_gain: NonNegative = 0.3
    """K_f on the position, m/m. Below 1, as the planner answers the same error at its next plan."""
    turn_gain: NonNegative = 0.0
    """K_f on the orientation, rad/rad. Off: a hand that touches is turned by what it touches, and what that feedback is
    worth was not measured."""
    force_gain: NonNegative = 0.1
    """K_f on the force, N/N."""
    torque_gain: NonNegative = 0.0
    """K_f on the torque, N m/N m. Off, as for the orientation."""
    memory_s: Positive = 0.1
    """Time constant of the leak."""
    most_m: NonNegative = 0.005
    """The position's feedback is no larger: a contact's uncertainty, so that it cannot drag the hand away from the
    plan."""
    most_rad: NonNegative = 0.05
    """The orientation's feedback is no larger."""
    most_n: NonNegative = 3.0
    """The force's feedback is no larger."""
    most_n_m: NonNegative = 0.3
    """The torque's feedback is no larger."""
    force_limit_n: Positive = 45.0
    """The impedance never pulls harder than this, and yields where the hand feels more. The usual lead of the spring (6
    cm at 600 N/m) just stays within it."""


class Reactive:
    """Turns planned targets into commands.

    Args:
        cfg: Gains and limits.
        period_s: Of the control.
        low_m: Shape=(3,), corner of the box that commands stay in.
        high_m: Shape=(3,), the opposite corner.
    """

    def __init__(self, cfg: ReactiveCfg, period_s: float, low_m: Array, high_m: Array) -> None:
        self.cfg, self._low, self._high = cfg, np.asarray(low_m, float), np.asarray(high_m, float)
        self._keep = float(np.exp(-period_s / cfg.memory_s))
        self.reset()

    def reset(self) -> None:
        """Forget what went otherwise: another strategy has begun."""
        self.position_error, self.turn_error = np.zeros(3), np.zeros(3)
        self.force_error, self.torque_error = np.zeros(3), np.zeros(3)
        self._before, self._since = np.zeros(6), np.zeros(6)

    def observe(
        self,
        expected_position: Array,
        expected_force: Array,
        now: Observation,
        k: int = 0,
        expected_quaternion: Array | None = None,
        expected_torque: Array | None = None,
    ) -> None:
        """Compare what a control step brought with what the plan that it was taken from expected of it.

        Args:
            expected_position: Shape=(3,) m, of the tool.
            expected_force: Shape=(3,) N, on the hand.
            now: Measured after the step.
            k: Which step of its plan it was: a plan's error grows from its beginning, and is summed over plans.
            expected_quaternion: Shape=(4,), of the tool; None where nothing was expected of it.
            expected_torque: Shape=(3,) N m, on the hand about the tool; None likewise.
        """
        if k == 0:
            self._before = self._before + self._since
        self._before = self._keep * self._before
        turned = (
            np.zeros(3)
            if expected_quaternion is None
            else to_rotvec(multiply(expected_quaternion, conjugate(now.tool.quaternion)))
        )
        self._since = np.concatenate([expected_position - now.tool.position, turned])
        self.position_error, self.turn_error = np.split(self._before + self._since, 2)
        # A force is not integrated by the world as a velocity is: its mean error counts, not its sum.
        self.force_error = self._keep * self.force_error + (1.0 - self._keep) * (expected_force - now.wrench[:3])
        if expected_torque is not None:
            self.torque_error = self._keep * self.torque_error + (1.0 - self._keep) * (expected_torque - now.wrench[3:])

    def command(self, target: HandTarget, now: Observation) -> HandTarget:
        """What is sent to the hand: the planned target, fed back and within the limits."""
        cfg = self.cfg
        position, quaternion, force, torque = target.position, target.quaternion, target.force, target.torque
        if cfg.enabled:
            position = position + _short(cfg.pose_gain * self.position_error, cfg.most_m)
            if cfg.turn_gain:
                quaternion = multiply(from_rotvec(_short(cfg.turn_gain * self.turn_error, cfg.most_rad)), quaternion)
            # Felt and exerted force are opposite: where less was felt than expected, push further.
            force = force - _short(cfg.force_gain * self.force_error, cfg.most_n)
            if cfg.torque_gain:
                torque = torque - _short(cfg.torque_gain * self.torque_error, cfg.most_n_m)
        # A force that is pushed in addition counts for the limit as the displacement that would make it.
        lead = np.clip(position, self._low, self._high) - now.tool.position + force / target.stiffness
        lead = _short(self._yielding(lead, now), cfg.force_limit_n / target.stiffness)
        position = np.clip(now.tool.position + lead - force / target.stiffness, self._low, self._high)
        position, force = self._weaker(position, force, target.stiffness, now)
        opening = float(np.clip(target.opening_m, SQUEEZE_M, MAX_OPENING_M))
        return replace(target, position=position, quaternion=quaternion, opening_m=opening, force=force, torque=torque)

    def _weaker(self, position: Array, force: Array, stiffness: float, now: Observation) -> tuple[Array, Array]:
        """Where the box lets them pull harder than the limit: both less, in proportion, on the way to the hand.

        From inside the box that stays inside; from outside the limit counts, and the hand comes back slowly.
        """
        way = position - now.tool.position
        share = min(1.0, self.cfg.force_limit_n / max(stiffness * float(np.linalg.norm(way + force / stiffness)), 1e-9))
        return (position, force) if share > 1.0 - 1e-9 else (now.tool.position + share * way, share * force)

    def _yielding(self, lead: Array, now: Observation) -> Array:
        """The hand's lead, its part against a resistance beyond the limit scaled back to the limit."""
        felt = float(np.linalg.norm(now.wrench[:3]))
        if felt <= self.cfg.force_limit_n:
            return lead
        push = -now.wrench[:3] / felt
        into = max(0.0, float(lead @ push))
        return lead - into * (1.0 - self.cfg.force_limit_n / felt) * push


def _short(vector: Array, most: float) -> Array:
    """The vector, no longer than `most`."""
    length = float(np.linalg.norm(vector))
    return vector if length <= most else vector * (most / length)
