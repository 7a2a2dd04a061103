"""Paths of one plan's rehearsals, for a viewer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context

Array = NDArray[np.float64]
DRAWN = 24
"""Number of rehearsals whose paths are kept."""


@dataclass(frozen=True)
class RehearsedPaths:
    """Copies: the rehearsals' own memory is used again by the next plan."""

    best: Array
    """Path of the tool in the rehearsal with the largest weight, Shape=(H, 3) m."""
    some: Array
    """Paths of the tool in some rehearsals, Shape=(n, H, 3) m."""
    objects: Mapping[str, Array]
    """Path of each object in the rehearsal with the largest weight, Shape=(H, 3) m."""


def keep_paths(context: Context, sane: NDArray[np.bool_], weights: Array, names: Sequence[str]) -> RehearsedPaths:
    """Copy the paths of the rehearsal with the largest weight, and the tool's in some others.

    Args:
        context: The rehearsed states.
        sane: Shape=(K,), which rehearsals are valid.
        weights: Shape=(K,), of the update.
        names: The objects.
    """
    best, valid = int(np.argmax(weights)), np.flatnonzero(sane)
    some = valid[:: max(1, len(valid) // DRAWN)]
    objects = {name: np.array(context[f"{name}_pos"][best]) for name in names}
    return RehearsedPaths(np.array(context.ee_pos[best]), np.array(context.ee_pos[some]), objects)
