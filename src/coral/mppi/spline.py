"""Control sequences as splines: sampling changes a few knots over the horizon, steps between them are interpolated."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Kind = Literal["hold", "linear", "cubic"]


def basis(times: Array, knots: int, span: float, kind: Kind = "linear") -> Array:
    """Compute B, Shape=(T, knots), with values(times) = B @ knot values, for knots evenly over [0, span].

    The value is constant before the first and after the last knot. "cubic" is Catmull-Rom: it passes through the knots.
    """
    return _basis(tuple(np.asarray(times, dtype=float)), knots, float(span), kind)


@lru_cache(maxsize=64)
def _basis(times: tuple[float, ...], knots: int, span: float, kind: Kind) -> Array:
    place = np.clip(np.asarray(times) / span, 0.0, 1.0) * (knots - 1)
    left = np.minimum(place.astype(int), max(knots - 2, 0))
    share = place - left
    matrix = np.zeros((len(times), knots))
    rows = np.arange(len(times))
    if knots == 1:
        matrix[:, 0] = 1.0
    elif kind == "hold":
        # A time that falls on a knot must not miss it by rounding.
        matrix[rows, np.minimum((place + 1e-9).astype(int), knots - 1)] = 1.0
    elif kind == "linear":
        matrix[rows, left] = 1.0 - share
        matrix[rows, left + 1] += share
    else:
        s, s2, s3 = share, share**2, share**3
        weights = (-0.5 * s3 + s2 - 0.5 * s, 1.5 * s3 - 2.5 * s2 + 1, -1.5 * s3 + 2 * s2 + 0.5 * s, 0.5 * s3 - 0.5 * s2)
        for shift, weight in zip((-1, 0, 1, 2), weights, strict=True):
            np.add.at(matrix, (rows, np.clip(left + shift, 0, knots - 1)), weight)
    matrix.flags.writeable = False  # the cache returns it again
    return matrix


def interpolate(knots: Array, times: Array, span: float, kind: Kind = "linear") -> Array:
    """Compute the values, Shape=(..., T, nu), at `times`, Shape=(T,), of splines with knots of Shape=(..., n, nu)."""
    return np.asarray(basis(times, knots.shape[-2], span, kind) @ knots)


def shift(knots: Array, by: float, span: float, kind: Kind = "linear") -> Array:
    """Shift a spline by `by` in time, Shape=(n, nu): the warm start of the next plan. The last value is held."""
    count = knots.shape[-2]
    times = np.linspace(0.0, span, count) + by
    return interpolate(knots, times, span, kind)
