"""Area of oysters from pictures: the part of the sea floor that they cover, finer than a cell of the map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Fraction, Positive
from coral.reef.products.cover_kernels import vote
from coral.reef.products.seen_points import find_points, grid_shape
from coral.reef.recordings.recording import Recording

NORMAL_95 = 1.96


@dataclass(frozen=True, kw_only=True)
class CoverCfg:
    """How pictures become an area."""

    fine_m: Positive = 0.02
    """Edge of the fine cells: about a pixel at 2 m. A map cell of 0.05 m counts whole if a shell touches it, which
    makes an area some 40 % too large; the fine cells hold shares."""
    range_m: Positive = 3.0
    """Pictures from farther away do not count: a pixel is then wider than half a shell."""
    gap_m: Positive = 0.08
    """Fine cells that no pixel hit lie this near to some that were hit; half a shell's length. What is farther is not
    seen."""
    beside_m: Positive = 0.1
    """Oysters are counted within this distance of the map's oyster cells. The map outvotes masks that are wrong."""
    edge: Fraction = 0.03
    """Relative standard deviation of what edges of shells add or take, even where all is seen: three clusters of s1
    without gaps came out 3 to 6 % too large."""
    subsets: Count = 8
    """Interleaved subsets of the pictures, for the error of sampling: each is left out once (jackknife)."""


@dataclass(frozen=True)
class Area:
    """An area of oysters with the interval that should contain the truth in 95 of 100 cases (m²)."""

    m2: float
    low_m2: float
    high_m2: float


@dataclass(frozen=True)
class Cover:
    """The share of oysters in every fine cell, twice: as seen, and with the gaps filled."""

    cfg: CoverCfg
    seen: NDArray[np.float32]
    """Share where a pixel hit, 0 elsewhere. Shape=(FY, FX)."""
    filled: NDArray[np.float32]
    """The same with each gap as its nearest neighbour. Shape=(FY, FX)."""
    known: NDArray[np.bool_]
    """Fine cells that were seen, or are gaps between some that were. Shape=(FY, FX)."""


def measure_cover(recording: Recording, cfg: CoverCfg) -> tuple[Cover, list[Cover]]:
    """Measure the cover from all pictures of a located recording, and from all but each subset.

    A fine cell's share is that of the votes for oyster among the votes of its pixels. Where no pixel hit, behind shells
    and in their shade, nobody knows: `seen` has no oysters there, and `filled` what lies nearest.
    """
    shape = grid_shape(recording, cfg.fine_m)

    def empty() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        return np.zeros(shape, np.float32), np.zeros(shape, np.float32)

    whole = empty()
    parts = [empty() for _ in range(cfg.subsets)] if cfg.subsets > 1 else []
    for number, keyframe in enumerate(recording.keyframes()):
        votes = parts[number % cfg.subsets] if parts else whole
        points = find_points(keyframe, recording, cfg.fine_m, shape, cfg.range_m)
        vote(points.cell, points.frame.depth, points.frame.labels, *votes)
    for oyster, floor in parts:
        whole[0][...] += oyster
        whole[1][...] += floor
    without = [_cover(whole[0] - oyster, whole[1] - floor, cfg) for oyster, floor in parts]
    return _cover(*whole, cfg), without


def area_within(cover: Cover, without: list[Cover], region: NDArray[np.bool_]) -> Area:
    """Return the area of oysters in a region of fine cells, Shape=(FY, FX), with its interval.

    The area is the middle of what was seen and what may be: gaps hide oysters and floor alike, in an unknown share that
    is taken as equally likely between none and all (standard deviation: range / sqrt(12)). The error of sampling is
    that of the delete-a-group jackknife. Edges of shells add a share of the area (`CoverCfg.edge`). All together,
    times 1.96, are the interval. It knows nothing of wrong masks.
    """
    unit = cover.cfg.fine_m**2
    low, high = (float(part[region].sum(dtype=np.float64)) * unit for part in (cover.seen, cover.filled))
    middle, unknown = 0.5 * (low + high), (high - low) / math.sqrt(12.0)
    replicates = np.array(
        [0.5 * unit * float(one.seen[region].sum(dtype=np.float64) + one.filled[region].sum(dtype=np.float64))
         for one in without]
    )  # fmt: skip
    count = len(replicates)
    sampling = 0.0 if count < 2 else (count - 1) / count * float(((replicates - replicates.mean()) ** 2).sum())
    half = NORMAL_95 * math.sqrt(unknown**2 + sampling + (cover.cfg.edge * middle) ** 2)
    return Area(middle, max(middle - half, 0.0), middle + half)


def fine_of(cells: NDArray[np.bool_], cell_m: float, cover: Cover) -> NDArray[np.bool_]:
    """Return a mask of map cells, Shape=(NY, NX), on the fine cells, Shape=(FY, FX)."""
    fy, fx = cover.seen.shape
    ny, nx = cells.shape
    iy = np.minimum(((np.arange(fy) + 0.5) * cover.cfg.fine_m / cell_m).astype(np.intp), ny - 1)
    ix = np.minimum(((np.arange(fx) + 0.5) * cover.cfg.fine_m / cell_m).astype(np.intp), nx - 1)
    return cells[np.ix_(iy, ix)]


def _cover(oyster: NDArray[np.float32], floor: NDArray[np.float32], cfg: CoverCfg) -> Cover:
    votes = oyster + floor
    hit = votes > 1e-4  # a difference of sums of float32 may leave a speck
    seen = np.where(hit, np.clip(oyster / np.maximum(votes, 1e-4), 0.0, 1.0), 0.0).astype(np.float32)
    if not hit.any():
        return Cover(cfg, seen, seen, hit)
    away, nearest = cv2.distanceTransformWithLabels(
        (~hit).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    known = np.asarray(away * cfg.fine_m <= cfg.gap_m)
    share = np.zeros(int(nearest.max()) + 1, np.float32)
    share[nearest[hit]] = seen[hit]
    return Cover(cfg, seen, np.where(known, share[nearest], np.float32(0.0)), known)
