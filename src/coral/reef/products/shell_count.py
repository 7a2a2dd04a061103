"""How many oysters, and how long: from the cover of the sea floor, in which shells touch, overlap and hide others."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.products.cover import NORMAL_95, SurveyEstimate

LEAST_SINGLES = 10
"""Shells that lie apart, fewer than which tell no size."""
_LEAST_CELLS = 6
"""Of a shell: smaller ones have no shape on the grid."""
_ELLIPSE = 0.85
"""Overlap (IoU) of a patch with its ellipse from which it is one shell: two that touch have a waist."""
_LARGEST = 2.2
"""Times the median area: larger ellipses are several shells."""
_WINDOW, _CONVEX = 0.5, 1.07
"""Standard deviation of the window in which shells lie at random, in shell lengths, and what so narrow a window adds
to their number: 1.12 to 1.16 where shells lie at random, 0.97 to 1.04 in the piles of six generated reefs, which are
denser in their middle; the one factor for both is the middle."""
_MODEL = 0.07
"""Relative standard deviation of the number by that compromise."""
_PEAK = 0.35
"""Height of a shell's middle above its patch's edge, over the half width of a shell, from which it counts."""
_BULGES, _BULGES_ERROR = 1.19, 0.16
"""Bulges of a mask for an oyster that people outline, and the standard deviation of its logarithm from video to video:
3520 oysters outlined by hand in 116 frames of 12 videos. Patches alone are 0.41 for an oyster."""


@dataclass(frozen=True)
class Singles:
    """Shells that lie apart, whole and with a shape of their own. Shape=(N,) each."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    """Middle (m)."""
    length: NDArray[np.float64]
    width: NDArray[np.float64]
    """Axes of the ellipse with the same moments (m)."""
    area: NDArray[np.float64]
    """Seen from above (m²)."""


@dataclass(frozen=True)
class ShellCount:
    """How many oysters lie on the sea floor that was seen near enough; None where too few lie apart.

    What a network saw is then no shape of a shell.
    """

    singles: Singles
    outlines: SurveyEstimate | None = None
    """Those that a person would tell apart from above."""
    length: SurveyEstimate | None = None
    """Mean length (m)."""
    oysters: SurveyEstimate | None = None
    """Number, with those that lie beneath others."""


def count_shells(
    seen: NDArray[np.float32], filled: NDArray[np.float32], cell_m: float, area_error: float = 0.0
) -> ShellCount:
    """Count shells in the share of oysters of each cell, Shape=(FY, FX): as seen, none in gaps, and with gaps filled.

    Those that lie apart give the size of one. How many there are follows from the cover p by the Boolean model, in
    which shells of mean area a lie on each other at random: p = 1 - exp(-density a) (Matheron 1975; Chiu et al.,
    Stochastic Geometry and its Applications, 3.1), in a window about each place. `area_error` is the relative standard
    deviation of the area of oysters.
    """
    share = np.asarray(0.5 * (seen + filled), np.float32)
    singles = find_singles(share, cell_m)
    count = len(singles.area)
    if count < LEAST_SINGLES:
        return ShellCount(singles)
    apart, spread = count_bulges(share >= 0.5) / _BULGES, math.exp(NORMAL_95 * _BULGES_ERROR)
    outlines = SurveyEstimate(apart, apart / spread, apart * spread)
    one, length = float(singles.area.mean()), float(singles.length.mean())
    window = _WINDOW * length / cell_m
    number = covered_number(share, window) * cell_m**2 / one / _CONVEX
    more = covered_number(np.float32(1.01) * share, window) * cell_m**2 / one / _CONVEX
    elasticity = (more / max(number, 1e-9) - 1.0) / 0.01
    size_error = float(singles.area.std(ddof=1)) / one / math.sqrt(count)
    error = number * math.sqrt(size_error**2 + (elasticity * area_error) ** 2 + _MODEL**2)
    return ShellCount(
        singles,
        outlines,
        SurveyEstimate.around(length, float(singles.length.std(ddof=1)) / math.sqrt(count) + 0.25 * cell_m),
        SurveyEstimate.around(number, error),
    )


def covered_number(share: NDArray[np.float32], window: float) -> float:
    """Return the sum of -ln(1 - p) over cells, Shape=(FY, FX): areas of all shells, also hidden ones, in cells.

    `window` is the standard deviation of the window of p (cells).
    """
    mean = cv2.GaussianBlur(share.astype(np.float32), (0, 0), max(window, 0.5))
    return float(-np.log1p(-np.clip(mean, 0.0, 0.97)).sum(dtype=np.float64))


def find_singles(share: NDArray[np.float32], cell_m: float) -> Singles:
    """Find the shells that lie apart: patches that are as good as ellipses."""
    mask = (share >= 0.5).astype(np.uint8)
    count, label, boxes, _ = cv2.connectedComponentsWithStats(mask, connectivity=4)
    rows = []
    for k in range(1, count):
        x, y, width, height, cells = (int(value) for value in boxes[k])
        if cells >= _LEAST_CELLS:
            rows.append(_ellipse(label[y : y + height, x : x + width] == k, x, y, cell_m))
    found = np.array([row[1:] for row in rows if row[0] >= _ELLIPSE], np.float64).reshape(-1, 5)
    if len(found):
        found = found[found[:, 4] < _LARGEST * np.median(found[:, 4])]
    return Singles(*found.T)


def count_bulges(mask: NDArray[np.bool_]) -> int:
    """Count what of a mask may be a shell of its own: each patch, or each of its bulges.

    Bulges are peaks of the distance from the edge, at least half a shell's width apart. The median patch tells it.
    Patches too small to have a shape are specks of a network.
    """
    patches = np.pad(mask, 1).astype(np.uint8)
    _, label, boxes, _ = cv2.connectedComponentsWithStats(patches, connectivity=4)
    patches[boxes[label, cv2.CC_STAT_AREA] < _LEAST_CELLS] = 0
    away = cv2.distanceTransform(patches, cv2.DIST_L2, 5)
    count, label = cv2.connectedComponents((away > 0.0).astype(np.uint8), connectivity=4)
    if count < 2:
        return 0
    deepest = np.zeros(count)
    inside = label > 0
    for k, depth in zip(label[inside].tolist(), away[inside].tolist(), strict=True):
        deepest[k] = max(deepest[k], depth)
    half = float(np.median(deepest[1:]))
    near = max(3, round(half)) | 1
    peaks = (away == cv2.dilate(away, np.ones((near, near), np.uint8))) & (away > _PEAK * half)
    return int(cv2.connectedComponents(peaks.astype(np.uint8))[0]) - 1


def _ellipse(patch: NDArray[np.bool_], x: int, y: int, cell_m: float) -> tuple[float, ...]:
    """Return how much of a patch its ellipse is (IoU); middle, length, width (m) and area (m²)."""
    part = np.pad(patch, 3)
    iy, ix = np.nonzero(part)
    values, ways = np.linalg.eigh(np.cov(np.stack([ix, iy])) + np.eye(2) / 12.0)
    axes = 2.0 * np.sqrt(values)
    grid = np.stack(np.meshgrid(np.arange(part.shape[1]) - ix.mean(), np.arange(part.shape[0]) - iy.mean()), -1)
    inside = (((grid @ ways) / axes) ** 2).sum(axis=-1) <= 1.0
    overlap = float((inside & part).sum() / (inside | part).sum())
    middle = (x + ix.mean() - 3 + 0.5) * cell_m, (y + iy.mean() - 3 + 0.5) * cell_m
    return (overlap, *middle, 2.0 * axes[1] * cell_m, 2.0 * axes[0] * cell_m, len(ix) * cell_m**2)
