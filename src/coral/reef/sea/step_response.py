"""Fits a gain, a lag, a delay and a slowly trailing share to how a speed followed its set-points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.errors import RunError

Array = NDArray[np.float64]

LAGS_S = np.arange(0.05, 1.01, 0.05)
DELAYS_S = np.arange(0.0, 0.51, 0.05)
TRAIL_LAGS_S = np.array([1.0, 1.5, 2.0, 3.0, 4.0, 6.0])
MOST_SAMPLES = 600
"""More measurements than this are thinned out for the fit."""
LEAST_GAIN = 0.2
"""A vehicle that reaches less of what is asked does not follow."""


@dataclass(frozen=True, kw_only=True)
class StepResponse:
    """y(t) is the command of t - delay behind a lag; a share `trail` of it is behind a longer one."""

    gain: float
    lag_s: float
    delay_s: float
    trail: float = 0.0
    trail_lag_s: float = 2.0
    error: float
    """Root mean square of what the model does not explain, in units of y."""


def lagged(t: Array, at: Array, command: Array, lag_s: float, delay_s: float) -> Array:
    """Return a command behind a delay (s) and a first-order lag (s), at the times `t` (s). Shape=(N,).

    `command` is what it changed to at the times `at` (s), Shape=(M,); 0 before.
    """
    since = np.maximum(t[:, None] - at[None, :] - delay_s, 0.0)
    return np.asarray(-np.expm1(-since / lag_s) @ np.diff(command, prepend=0.0))


def fit_step_response(t: Array, y: Array, at: Array, command: Array, *, trails: bool) -> StepResponse:
    """Find the least-squares response: a grid over lags and delay, gain and share in closed form.

    `y` are the speeds measured at `t` (s), Shape=(N,), `command` the set-points given at `at` (s), Shape=(M,).
    `trails`: a share may trail behind.

    Raises:
        RunError: The vehicle did not follow.
    """
    changes = np.diff(command, prepend=0.0) != 0.0
    at, command = at[changes], command[changes]
    thin = max(1, len(t) // MOST_SAMPLES)
    t, y = t[::thin], y[::thin]
    best = StepResponse(gain=0.0, lag_s=0.25, delay_s=0.0, error=float("inf"))
    for delay in DELAYS_S:
        slow = [lagged(t, at, command, lag, delay) for lag in (TRAIL_LAGS_S if trails else ())]
        for lag in LAGS_S:
            fast = lagged(t, at, command, lag, delay)
            for trail_lag, shapes in [
                (2.0, (fast,)),
                *((T, (fast, s)) for T, s in zip(TRAIL_LAGS_S, slow, strict=False)),
            ]:
                found = np.linalg.lstsq(np.stack(shapes, axis=1), y, rcond=None)[0]
                if np.any(found <= 0.0):
                    continue
                error = float(np.sqrt(np.mean((y - np.stack(shapes, axis=1) @ found) ** 2)))
                if error < best.error - 1e-9:
                    gain = float(found.sum())
                    share = float(found[1] / gain) if len(found) > 1 else 0.0
                    best = StepResponse(
                        gain=gain, lag_s=float(lag), delay_s=float(delay), trail=share, trail_lag_s=float(trail_lag),
                        error=error,
                    )  # fmt: skip
    if not best.gain > LEAST_GAIN:
        raise RunError(f"the vehicle did not follow its set-points: it reached {best.gain:.0%} of them")
    return best
