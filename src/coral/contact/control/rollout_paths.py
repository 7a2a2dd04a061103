"""Paths of one plan's rollouts, for a viewer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context

Array = NDArray[np.float64]
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


def keep_paths(context: Context, sane: NDArray[np.bool_], weights: Array, names: Sequence[str]) -> RolloutPaths:
    """Copy the paths of the rollout with the largest weight, and the tool's in some others.

    Args:
        context: The states of the rollouts.
        sane: Shape=(K,), which rollouts are valid.
        weights: Shape=(K,), of the update.
        names: The objects.
    """
    best, valid = int(np.argmax(weights)), np.flatnonzero(sane)
    some = valid[:: max(1, len(valid) // DRAWN)]
    objects = {name: np.array(context[f"{name}_pos"][best]) for name in names}
    return RolloutPaths(np.array(context.ee_pos[best]), np.array(context.ee_pos[some]), objects)
