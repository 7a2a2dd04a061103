"""A plan of the hand, which every controller of the hand returns, and the paths of its rollouts for a viewer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context
from coral.contact.scene.observation import Array, HandTarget
from coral.mppi.knots import Update

DRAWN = 24
"""Number of rollouts whose paths are kept."""


@dataclass(frozen=True)
class RolloutPaths:
    """Copies: the next plan reuses the rollouts' own memory."""

    best: Array
    """Path of the tool in the rollout with the largest weight, Shape=(H, 3) m."""
    some: Array
    """Paths of the tool in some rollouts, Shape=(n, H, 3) m."""
    objects: Mapping[str, Array]
    """Path of each object in the rollout with the largest weight, Shape=(H, 3) m."""


@dataclass(frozen=True)
class HandPlan:
    """One plan. Only its targets are necessary; without predictions there is no reactive feedback (Eq. 7)."""

    targets: tuple[HandTarget, ...]
    """One target for each control step of the horizon."""
    expected_position: Array | None = None
    """Predicted position of the tool, Shape=(H, 3) m; None, like the next, without a prediction."""
    expected_force: Array | None = None
    """Predicted force on the hand, Shape=(H, 3) N."""
    terms: Mapping[str, float] = field(default_factory=dict)
    """Expected value of each cost term over the horizon."""
    now: Context | None = None
    """State after one step, a batch of one, for a stage's conditions; None leaves it to the planning world."""
    update: Update | None = None
    """Update of the sampler; None of a controller that does not sample."""
    valid: bool = True
    """Whether there is a valid rollout; if not, the previous plan is kept."""
    diverged: int = 0
    """Number of excluded rollouts."""
    paths: RolloutPaths | None = None
    """Paths of rollouts, for a viewer."""
    at_edge: float = 0.0
    """Share of the targets at the edge of the workspace or of the arm's reach."""

    @property
    def cost(self) -> float:
        """Return the expected cost of the plan."""
        return float(sum(self.terms.values()))

    @property
    def effective_samples(self) -> float:
        """Return the effective sample size; 1 of a controller that does not sample."""
        return 1.0 if self.update is None else self.update.effective_samples


def keep_paths(context: Context, sane: NDArray[np.bool_], weights: Array, names: Sequence[str]) -> RolloutPaths:
    """Copy the paths of the valid (`sane`) rollout with the largest weight, and the tool's in some others."""
    best, valid = int(np.argmax(weights)), np.flatnonzero(sane)
    some = valid[:: max(1, len(valid) // DRAWN)]
    objects = {name: np.array(context[f"{name}_pos"][best]) for name in names}
    return RolloutPaths(np.array(context.ee_pos[best]), np.array(context.ee_pos[some]), objects)
