"""Control sequences as splines: sampling changes a few knots over the horizon, steps between them are interpolated."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def basis(times: Array, knots: int, span: float) -> Array:
    """Compute B, Shape=(T, knots), with values(times) = B @ knot values, for knots evenly over [0, span].

    Values are linear between knots, and constant before the first and after the last one.
    """
    return _basis(tuple(np.asarray(times, dtype=float)), knots, float(span))


@lru_cache(maxsize=64)
def _basis(times: tuple[float, ...], knots: int, span: float) -> Array:
    place = np.clip(np.asarray(times) / span, 0.0, 1.0) * (knots - 1)
    left = np.minimum(place.astype(int), max(knots - 2, 0))
    share = place - left
    matrix = np.zeros((len(times), knots))
    rows = np.arange(len(times))
    matrix[rows, left] = 1.0 - share
    if knots > 1:
        matrix[rows, left + 1] += share
    matrix.flags.writeable = False  # the cache returns it again
    return matrix


def interpolate(knots: Array, times: Array, span: float) -> Array:
    """Compute the values, Shape=(..., T, nu), at `times`, Shape=(T,), of splines with knots of Shape=(..., n, nu)."""
    return np.asarray(basis(times, knots.shape[-2], span) @ knots)


def shift(knots: Array, by: float, span: float) -> Array:
    """Shift a spline by `by` in time, Shape=(n, nu): the warm start of the next plan. The last value is held."""
    return interpolate(knots, np.linspace(0.0, span, knots.shape[-2]) + by, span)
