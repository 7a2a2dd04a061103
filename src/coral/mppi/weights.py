"""The update law of model predictive path integral control: weights of rollouts and their mean."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def softmax_weights(costs: Array, temperature: float) -> Array:
    """Compute the information-theoretic weights exp(-(J - min J) / lambda), normalised.

    Args:
        costs: Shape=(K,) cost of each rollout; inf for an invalid one.
        temperature: lambda > 0, in units of the cost.

    Returns:
        Shape=(K,) weights that sum to 1, or all zero if no cost is finite.
    """
    weights = np.zeros_like(costs)
    finite = np.flatnonzero(np.isfinite(costs))
    if finite.size == 0:
        return weights
    chosen = np.exp(-(costs[finite] - costs[finite].min()) / temperature)
    weights[finite] = chosen / chosen.sum()
    return weights


def effective_sample_size(weights: Array) -> float:
    """Compute 1 / sum of squared weights: 1 if one rollout dominates, K if all count alike, 0 if none counts."""
    squares = float(np.square(weights).sum())
    return 1.0 / squares if squares > 0.0 else 0.0


def weighted_mean(weights: Array, sequences: Array) -> Array:
    """Compute the mean control sequence, Shape=(T, nu), of Shape=(K, T, nu) with weights of Shape=(K,)."""
    return np.asarray(np.tensordot(weights, sequences, axes=1))
