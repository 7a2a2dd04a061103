"""Does the lens agree with the pictures? The sea floor of neighbouring pictures, of known poses and heights, tells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.recordings.run_recording import read_run
from coral.reef.vehicle.camera import CameraCfg, T_world_camera

RATIOS = np.geomspace(0.4, 2.5, 47)
"""Focal lengths that are tried, as multiples of the stated one."""
LEAST_MOVED, MOST_MOVED = 0.1, 0.8
"""Motion between two pictures that are compared, in heights above the floor."""
PAIRS, LEAST_PAIRS = 30, 5
"""Most pairs that are looked at, and fewest that say anything."""
LEAST_MATCHES = 10
"""Of a pair."""
_PIXELS = 0.012
"""Error, as a share of the picture's width, from which a match counts as wrong."""
_RATIO_TEST = 0.8
"""Lowe's: distance of the best match over that of the second."""
_AGREES = 1.2
"""Factor within which a focal length agrees: heights and flow are that uncertain."""
_SURE = 2.0
"""Standard errors by which another focal length must be better."""


@dataclass(frozen=True)
class LensFit:
    """What matches between pictures say about the focal length."""

    ratio: float
    """Best focal length over the stated one."""
    halves: tuple[float, float]
    """The same, of every second pair and of the others."""
    sure: float
    """By how many standard errors matches fit it better than the stated one."""
    pairs: int
    matches: int

    @property
    def disagrees(self) -> bool:
        """Whether another focal length is clearly better, and both halves of the pairs say the same one."""
        near = all(1.0 / _AGREES < half / self.ratio < _AGREES for half in self.halves)
        return not 1.0 / _AGREES < self.ratio < _AGREES and near and self.sure > _SURE


def check_lens(recording: Recording) -> str:
    """Return a line if the recording's pictures disagree with its lens; '' where they agree or do not tell."""
    fit = fit_lens(recording)
    if fit is None or not fit.disagrees:
        return ""
    camera = recording.camera
    half = math.tan(math.radians(camera.hfov_deg) / 2)
    better = 2.0 * math.degrees(math.atan(half / fit.ratio))
    return (
        f"the lens disagrees with the pictures: between neighbouring ones the sea floor moves as with a horizontal "
        f"field of view of {better:.0f}°, not {camera.hfov_deg:.0f}° ({fit.matches} points in {fit.pairs} pairs); or "
        f"height, tilt or scale of the poses are wrong"
    )


def check_run_lens(folder: Path) -> str:
    """Return what `check_lens` says about a run folder; '' if it has no pictures."""
    try:
        return check_lens(read_run(folder))
    except InputError:
        return ""


def fit_lens(recording: Recording) -> LensFit | None:
    """Find the focal length by which the floor lies in one place in neighbouring pictures; None where too few tell."""
    camera = recording.camera
    costs = []
    count = 0
    for first, second in _pairs(recording):
        points = match(first, second)
        if len(points) >= LEAST_MATCHES:
            costs.append(_cost(points, first, second, camera))
            count += len(points)
        if len(costs) == PAIRS:
            break
    if len(costs) < LEAST_PAIRS:
        return None
    every = np.array(costs)
    best, *halves = (int(np.argmin(part.mean(axis=0))) for part in (every, every[::2], every[1::2]))
    gain = every[:, int(np.argmin(np.abs(RATIOS - 1.0)))] - every[:, best]
    error = float(gain.std(ddof=1)) / math.sqrt(len(gain))
    return LensFit(
        ratio=float(RATIOS[best]),
        halves=(float(RATIOS[halves[0]]), float(RATIOS[halves[1]])),
        sure=float(gain.mean()) / max(error, 1e-9),
        pairs=len(costs),
        matches=count,
    )


def match(first: PosedFrame, second: PosedFrame) -> NDArray[np.float64]:
    """Return points that two pictures share: u, v in the one and in the other (px). Shape=(N, 4)."""
    finder: Any = getattr(cv2, "SIFT_create")(400, contrastThreshold=0.02)  # noqa: B009  (the stubs lack it)
    gray = [cv2.cvtColor(np.asarray(one.frame.rgb, np.uint8), cv2.COLOR_RGB2GRAY) for one in (first, second)]
    (keys, descriptors), (others, known) = (finder.detectAndCompute(one, None) for one in gray)
    if descriptors is None or known is None or len(known) < 2:
        return np.empty((0, 4))
    pairs = cv2.BFMatcher(cv2.NORM_L2).knnMatch(descriptors, known, k=2)
    good = [best for best, next_best in pairs if best.distance < _RATIO_TEST * next_best.distance]
    return np.array([(*keys[m.queryIdx].pt, *others[m.trainIdx].pt) for m in good], np.float64).reshape(-1, 4)


def floor_error(
    points: NDArray[np.float64], first: PosedFrame, second: PosedFrame, camera: CameraCfg, ratio: float
) -> NDArray[np.float64]:
    """Return how far matches are from where a flat floor puts them (px), inf where that is nowhere. Shape=(N,).

    `points` are of `match`, Shape=(N, 4); `ratio` is the focal length over the camera's stated one.
    """
    focal, _, cx, cy = camera.intrinsics
    focal *= ratio
    here, there = (
        T_world_camera(one.pose, camera, altitude=one.height_m, roll=one.roll, pitch=one.pitch)
        for one in (first, second)
    )
    rays = np.stack([(points[:, 0] - cx) / focal, (points[:, 1] - cy) / focal, np.ones(len(points))])
    ways = here[:3, :3] @ rays
    falls = ways[2] < -1e-6
    length = np.where(falls, here[2, 3] / np.where(falls, -ways[2], 1.0), np.inf)
    floor = here[:3, 3:] + np.where(falls, length, 0.0) * ways
    x, y, z = there[:3, :3].T @ (floor - there[:3, 3:])
    ahead = falls & (z > 1e-6)
    z = np.where(ahead, z, 1.0)
    error = np.hypot(focal * x / z + cx - points[:, 2], focal * y / z + cy - points[:, 3])
    return np.where(ahead, error, np.inf)


def _cost(points: NDArray[np.float64], first: PosedFrame, second: PosedFrame, camera: CameraCfg) -> NDArray[np.float64]:
    """Return the mean of each ratio's errors, wrong matches as 1. Shape=(len(RATIOS),)."""
    wrong = _PIXELS * camera.width
    return np.array([
        np.minimum(floor_error(points, first, second, camera, float(ratio)) / wrong, 1.0).mean() for ratio in RATIOS
    ])  # fmt: skip


def _pairs(recording: Recording) -> Iterator[tuple[PosedFrame, PosedFrame]]:
    last: PosedFrame | None = None
    for one in recording.keyframes():
        if one.frame.rgb is None:
            return
        if last is not None:
            moved = math.dist(one.pose[:2], last.pose[:2]) / one.height_m
            if moved < LEAST_MOVED:
                continue
            if moved < MOST_MOVED:
                yield last, one
        last = one
