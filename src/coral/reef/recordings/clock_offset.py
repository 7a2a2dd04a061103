"""The time between a video's clock and a log's: how its pictures turn, against how the vehicle says that it turned.

A camera that looks ahead shows a turn as a shift of the whole picture to the side. The shifts between neighbouring
pictures (phase correlation, Kuglin and Hines 1975) are compared with the log's yaw rate at every offset, by Pearson's
coefficient over what both have in common.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.recordings.pose_track import StampedTransforms
from coral.reef.recordings.transforms import euler_of

STEP_S = 0.2
"""Between the pictures that are compared."""
SHORTEST_S = 20.0
"""Of what video and log have in common."""
LEAST, RATIO, APART_S = 0.5, 0.6, 2.0
"""An offset is taken if its coefficient is so high, and none farther away than so long (s) exceeds this share of it;
`find_offset` says how this was measured."""
TURNING_RAD_S = 0.03
"""Standard deviation of a yaw rate that is more than its noise."""

Signal = NDArray[np.float64]


@dataclass(frozen=True)
class Offset:
    """The best offset, and how sure it is."""

    start_s: float
    """Time of the log at which the video begins (s)."""
    best: float
    """Coefficient there, 1 at most."""
    next_best: float
    """The highest one that is more than `APART_S` away."""

    @property
    def is_clear(self) -> bool:
        """Whether it is the only one that fits."""
        return self.best >= LEAST and self.next_best <= RATIO * self.best


def shifts(pictures: NDArray[np.uint8]) -> Signal:
    """Return how far each grey picture is shifted to the right against the one before it (px). Shape=(N, H, W)."""
    window = cv2.createHanningWindow((pictures.shape[2], pictures.shape[1]), cv2.CV_32F)
    floats = (one.astype(np.float32) for one in pictures)
    before, found = next(floats), list[float]()
    for after in floats:
        (right, _), _ = cv2.phaseCorrelate(before, after, window)
        found.append(right)
        before = after
    return _steady(np.array(found))


def yaw_rates(attitude: StampedTransforms, begin: float, end: float) -> Signal:
    """Return the yaw rate of a track every `STEP_S` between two times, 0 in its gaps (rad/s)."""
    times = np.array(attitude.times)
    yaw = np.unwrap([euler_of(one[:3, :3])[2] for one in attitude.transforms])
    grid = np.arange(begin, end, STEP_S)
    rates = np.diff(np.interp(grid, times, yaw)) / STEP_S
    middle = grid[:-1] + STEP_S / 2
    after = np.clip(np.searchsorted(times, middle), 1, len(times) - 1)
    rates[times[after] - times[after - 1] > attitude.gap_s] = 0.0
    return _steady(rates)


def find_offset(turns: Signal, attitude: StampedTransforms) -> Offset | None:
    """Return the offset at which a video's shifts fit a log's yaw rate best; None if one of them has no turns.

    The criterion was measured on made-up dives of 600 s (turns at random, lawn-mower with legs of 20 % jitter, and even
    ones), videos of 30 to 240 s, and noise of half the turns or as large: of 960 offsets none that was taken was wrong
    by more than 0.3 s, and of 960 videos of another dive none was taken, the nearest with a share of 0.64. All random
    dives from 120 s on were found; even legs, which fit at several offsets, never.
    """
    begin, end = attitude.times[0], attitude.times[-1]
    rates = yaw_rates(attitude, begin, end)
    least = round(SHORTEST_S / STEP_S)
    if min(len(turns), len(rates)) < least or float(np.std(rates)) < TURNING_RAD_S or not float(np.std(turns)) > 0.0:
        return None
    found, lags = _coefficients(turns, rates, max(least, len(turns) // 2 if len(turns) <= len(rates) else least))
    k = int(np.argmax(found))
    near = slice(max(k - 1, 0), k + 2)
    part = 0.0
    if 0 < k < len(found) - 1:
        low, top, high = found[near]
        part = float(0.5 * (low - high) / (low - 2 * top + high)) if low - 2 * top + high < 0.0 else 0.0
    others = found[np.abs(lags - lags[k]) * STEP_S > APART_S]
    return Offset(
        begin + (float(lags[k]) + part) * STEP_S, float(found[k]), float(others.max()) if others.size else 1.0
    )


def _coefficients(turns: Signal, rates: Signal, least: int) -> tuple[Signal, NDArray[np.int64]]:
    """Return Pearson's coefficient at each lag of `turns` in `rates` with so many common values, and the lags."""
    n, m = len(turns), len(rates)
    size = 1 << (n + m).bit_length()

    def cross(a: Signal, b: Signal) -> Signal:
        """Return the sum of a[i] b[i + lag] for lags from 1 - n."""
        both = np.fft.irfft(np.fft.rfft(a[::-1], size) * np.fft.rfft(b, size), size)
        return np.asarray(both[: n + m - 1])

    ones_n, ones_m = np.ones(n), np.ones(m)
    count = np.maximum(np.rint(cross(ones_n, ones_m)), 1.0)
    a, b = cross(turns, ones_m), cross(ones_n, rates)
    product = cross(turns, rates) - a * b / count
    spread = (cross(turns**2, ones_m) - a * a / count) * (cross(ones_n, rates**2) - b * b / count)
    quiet = spread < (1e-9 + 1e-3 * float(np.var(turns) * np.var(rates))) * count * count
    found = np.where(quiet, 0.0, product / np.sqrt(np.maximum(spread, 1e-12)))
    lags = np.arange(1 - n, m)
    enough = count >= least
    return found[enough], lags[enough]


def _steady(values: Signal) -> Signal:
    """Return values without outliers: a fish, or a picture that could not be compared."""
    middle = float(np.median(values))
    edge = 4.0 * float(np.median(np.abs(values - middle))) + 2.0 * float(np.std(values))
    return np.clip(values, middle - edge, middle + edge)
