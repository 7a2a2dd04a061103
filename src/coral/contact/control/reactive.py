"""Reactive feedback on the planned action (Eq. 7): nu = u + K_f (x_des - x_measured), on position and force.

Believed masses and frictions make the wrench that is planned: `believe` in `planning_world.py`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coral.config import NonNegative, Positive
from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.scene.observation import Array, HandTarget, Observation


@dataclass(frozen=True, kw_only=True)
class ReactiveCfg:
    """Gains and limits of the feedback.

    Every plan begins at the measured state, so x_des - x_measured is only the prediction error of one control step. It
    is therefore summed with a leak: the feedback acts on the error of the last `memory_s`, as if the plan had not been
    renewed.
    """

    enabled: bool = True
    """Whether K_f is nonzero; the limits apply in any case."""
    pose_gain: NonNegative = 0.3
    """K_f on the position, m/m. Below 1, because the next plan corrects the same error."""
    force_gain: NonNegative = 0.1
    """K_f on the force, N/N. Orientation and torque are not fed back: contact rotates the hand."""
    memory_s: Positive = 0.1
    """Time constant of the leak."""
    most_m: NonNegative = 0.005
    """Limit on the position's feedback: the uncertainty of a contact, so that it cannot drag the hand away from the
    plan."""
    most_n: NonNegative = 3.0
    """Limit on the force's feedback."""
    force_limit_n: Positive = 45.0
    """Limit on the pull of the impedance, which yields if the measured force is larger. The usual lead of the spring (6
    cm at 600 N/m) just stays within it."""


class Reactive:
    """Applies feedback and limits to planned targets; a box from `low_m` to `high_m`, Shape=(3,), bounds commands."""

    def __init__(self, cfg: ReactiveCfg, period_s: float, low_m: Array, high_m: Array) -> None:
        self.cfg, self._low, self._high = cfg, np.asarray(low_m, float), np.asarray(high_m, float)
        self._keep = float(np.exp(-period_s / cfg.memory_s))
        self.reset()

    def reset(self) -> None:
        """Clear the summed errors when a new strategy begins."""
        self.position_error, self.force_error = np.zeros(3), np.zeros(3)
        self._before, self._since = np.zeros(3), np.zeros(3)

    def observe(self, expected_position: Array, expected_force: Array, now: Observation, k: int = 0) -> None:
        """Compare the outcome of a control step with the prediction: the tool's position (m), force on the hand (N).

        `k` is the index of the step in its plan: a plan's error grows from its start, and is summed over plans.
        """
        if k == 0:
            self._before = self._before + self._since
        self._before = self._keep * self._before
        self._since = expected_position - now.tool.position
        self.position_error = self._before + self._since
        # The world does not integrate a force as it does a velocity: the mean error counts, not the sum.
        self.force_error = self._keep * self.force_error + (1.0 - self._keep) * (expected_force - now.wrench[:3])

    def command(self, target: HandTarget, now: Observation) -> HandTarget:
        """Compute the command: the planned target plus feedback, within the limits."""
        cfg = self.cfg
        position, force = target.position, target.force
        if cfg.enabled:
            position = position + _clip_length(cfg.pose_gain * self.position_error, cfg.most_m)
            # Measured and exerted force are opposite: push harder if less was measured than predicted.
            force = force - _clip_length(cfg.force_gain * self.force_error, cfg.most_n)
        # For the limit, an additional force counts as the displacement that would cause it.
        lead = np.clip(position, self._low, self._high) - now.tool.position + force / target.stiffness
        lead = _clip_length(self._limit_lead(lead, now), cfg.force_limit_n / target.stiffness)
        position = np.clip(now.tool.position + lead - force / target.stiffness, self._low, self._high)
        position, force = self._limit_pull(position, force, target.stiffness, now)
        opening = float(np.clip(target.opening_m, SQUEEZE_M, MAX_OPENING_M))
        return replace(target, position=position, opening_m=opening, force=force)

    def _limit_pull(self, position: Array, force: Array, stiffness: float, now: Observation) -> tuple[Array, Array]:
        """Reduce position lead and force in proportion if they exceed the limit within the box.

        A command inside the box stays inside; from outside, the limit applies and the hand returns slowly.
        """
        way = position - now.tool.position
        share = min(1.0, self.cfg.force_limit_n / max(stiffness * float(np.linalg.norm(way + force / stiffness)), 1e-9))
        return (position, force) if share > 1.0 - 1e-9 else (now.tool.position + share * way, share * force)

    def _limit_lead(self, lead: Array, now: Observation) -> Array:
        """Scale the lead's component against a resistance beyond the limit back to the limit."""
        felt = float(np.linalg.norm(now.wrench[:3]))
        if felt <= self.cfg.force_limit_n:
            return lead
        push = -now.wrench[:3] / felt
        into = max(0.0, float(lead @ push))
        return lead - into * (1.0 - self.cfg.force_limit_n / felt) * push


def _clip_length(vector: Array, most: float) -> Array:
    length = float(np.linalg.norm(vector))
    return vector if length <= most else vector * (most / length)
