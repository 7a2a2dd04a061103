"""Area of oysters from pictures: the part of the sea floor that they cover, finer than a cell of the map."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.foreign_file import read_json
from coral.reef.eyes.backends import PAINTED
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.eyes.reef_net import SHIPPED
from coral.reef.products.seen_points import find_points, grid_shape
from coral.reef.recordings.recording import Recording
from coral.reef.world.geometry import Frame, Label

NORMAL_95 = 1.96
SHARES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)
"""Edges between bins of the share of votes. Most cells are near 0 or 1."""
DEPTHS_M = (0.8, 1.0, 1.2, 1.4, 1.6, 2.0, 2.5)
"""Edges between bins of the depth of the nearest pixel (m)."""
ANY_DOUBT = DoubtCfg(oyster=1.0, obstacle=1.0, seabed=1.0)
BINS = (len(SHARES) + 1) * (len(DEPTHS_M) + 1)
FINE_M = 0.02
"""Edge of the fine cells: about a pixel at 2 m. A map cell of 0.05 m counts whole if a shell touches it, which makes an
area some 40 % too large; the fine cells hold shares."""
RANGE_M = 3.0
"""Pictures from farther away do not count: a pixel is then wider than half a shell."""
GAP_M = 0.08
"""Fine cells that no pixel hit lie this near to some that were hit; half a shell's length. What is farther is not
seen."""
BESIDE_M = 0.1
"""Oysters are counted within this distance of the map's oyster cells. The map outvotes masks that are wrong."""
EDGE = 0.03
"""Relative standard deviation of what edges of shells add or take, even where all is seen: three clusters of s1 without
gaps came out 3 to 6 % too large."""
CONFIRMED = 0.2
"""Least calibrated cover of a map cell with oysters, where a network is calibrated; with less it is none. On four of
the reefs of the calibration anything from 0.15 to 0.3 gives their seven clusters and an overlap of 0.59 to 0.64 with
the true cells; without it there were 11 or 12 clusters and an overlap of 0.42 to 0.46."""
SUBSETS = 8
"""Interleaved subsets of the pictures, for the error of sampling: each is left out once (jackknife)."""


@dataclass(frozen=True)
class SurveyEstimate:
    """A number, such as an area of oysters (m²), with the interval that should contain the truth in 95 of 100 cases."""

    value: float
    low: float
    high: float

    @classmethod
    def around(cls, value: float, error: float) -> SurveyEstimate:
        """Return a number that is not negative with the interval of its standard deviation."""
        return cls(value, max(value - NORMAL_95 * error, 0.0), value + NORMAL_95 * error)

    def times(self, factor: float) -> SurveyEstimate:
        """Return it in another unit."""
        return SurveyEstimate(factor * self.value, factor * self.low, factor * self.high)

    @property
    def relative_error(self) -> float:
        """Standard deviation as a share of the number; 0 for none."""
        return (self.high - self.value) / NORMAL_95 / self.value if self.value > 0.0 else 0.0


@dataclass(frozen=True)
class Cover:
    """The share of oysters in every fine cell, twice: as seen, and with the gaps filled."""

    seen: NDArray[np.float32]
    """Share where a pixel hit, 0 elsewhere. Shape=(FY, FX)."""
    filled: NDArray[np.float32]
    """The same with each gap as its nearest neighbour. Shape=(FY, FX)."""
    known: NDArray[np.bool_]
    """Fine cells that were seen, or are gaps between some that were. Shape=(FY, FX)."""
    calibration: CoverCalibration | None = None
    """Of the network that saw it; None where classes count as they are."""


@dataclass(frozen=True)
class Votes:
    """What pixels say about every fine cell."""

    oyster: NDArray[np.float32]
    """Votes for oyster. Shape=(FY, FX)."""
    floor: NDArray[np.float32]
    """Votes for sea floor. Shape=(FY, FX)."""
    nearest_m: NDArray[np.float32]
    """Depth of the nearest pixel (m), inf for none. Shape=(FY, FX)."""

    @classmethod
    def none(cls, shape: tuple[int, int]) -> Votes:
        """Begin without any."""
        return cls(np.zeros(shape, np.float32), np.zeros(shape, np.float32), np.full(shape, np.inf, np.float32))


def measure_cover(recording: Recording) -> tuple[Cover, list[Cover]]:
    """Measure the cover from all pictures of a located recording, and from all but each subset.

    A fine cell's share is that of the votes for oyster among the votes of its pixels. Where a network saw
    them whose errors are known (`CoverCalibration`), its probabilities vote, and the cover is what such shares have
    meant. Where no pixel hit, behind shells and in their shade, nobody knows: `seen` has no oysters there, and `filled`
    what lies nearest.
    """
    calibration = find_calibration(recording.seen_by)
    first = next((one.frame for one in recording.keyframes()), None) if calibration is not None else None
    if first is None or first.doubt is None:
        calibration = None  # frames of an old run: the network's probabilities were not kept
    parts = collect_votes(recording, soft=calibration is not None)
    whole = sum_votes(parts)
    without = [Votes(whole.oyster - one.oyster, whole.floor - one.floor, whole.nearest_m) for one in parts]
    covers = [make_cover(votes, calibration) for votes in (whole, *(without if len(parts) > 1 else ()))]
    return covers[0], covers[1:]


def collect_votes(recording: Recording, *, soft: bool) -> list[Votes]:
    """Let the pixels of each subset of the pictures of a located recording vote.

    `soft`: by a network's probabilities, however doubtful; if not, by their class, without those that are too doubtful
    for the map.
    """
    if soft:
        recording = with_doubt(recording, ANY_DOUBT)
    shape = grid_shape(recording, FINE_M)
    parts = [Votes.none(shape) for _ in range(SUBSETS)]
    for number, keyframe in enumerate(recording.keyframes()):
        votes = parts[number % len(parts)]
        points = find_points(keyframe, recording, FINE_M, shape, RANGE_M)
        likely = oyster_probability(points.frame, soft=soft)
        vote(points.cell, points.frame.depth, likely, votes)
    return parts


def with_doubt(recording: Recording, doubt: DoubtCfg) -> Recording:
    """Return a recording whose pixels count up to another doubt."""
    return replace(recording, map=replace(recording.map, doubt=doubt))


def vote(cell: NDArray[np.int64], depth: NDArray[np.float32], likely: NDArray[np.float32], votes: Votes) -> None:
    """Add a picture's votes for oyster and sea floor, `oyster_probability` (nan: none), to the cells of `find_points`.

    A pixel counts 1 / Z², so that one look from near outvotes many from afar, in parts for oyster and for sea floor.
    """
    told = (cell >= 0) & ~np.isnan(likely)
    at, z, share = cell[told], depth[told], likely[told]
    np.add.at(votes.oyster.reshape(-1), at, share / (z * z))
    np.add.at(votes.floor.reshape(-1), at, (1 - share) / (z * z))
    np.minimum.at(votes.nearest_m.reshape(-1), at, z)


def sum_votes(parts: list[Votes]) -> Votes:
    """Return the votes of all subsets together."""
    whole = Votes.none((parts[0].oyster.shape[0], parts[0].oyster.shape[1]))
    for one in parts:
        np.add(whole.oyster, one.oyster, out=whole.oyster)
        np.add(whole.floor, one.floor, out=whole.floor)
        np.minimum(whole.nearest_m, one.nearest_m, out=whole.nearest_m)
    return whole


def oyster_probability(frame: Frame, *, soft: bool) -> NDArray[np.float32]:
    """Return how likely each pixel shows an oyster, if it shows one or sea floor; nan for other classes. Shape=(H, W).

    A network's doubt of sea floor beside oysters is taken as its belief in oysters, which `CoverCalibration` corrects.
    A pixel that is doubted entirely is of a picture that was not judged: it says nothing.
    """
    oyster, floor = frame.labels == Label.OYSTER, frame.labels == Label.SEABED
    wrong = frame.doubt if soft and frame.doubt is not None else np.float32(0.0)
    if soft and frame.doubt is not None:
        oyster, floor = oyster & (frame.doubt < 1.0), floor & (frame.doubt < 1.0)
    likely = np.where(oyster, np.float32(1.0) - wrong, np.where(floor, wrong, np.float32(np.nan)))
    return likely.astype(np.float32)


def area_within(cover: Cover, without: list[Cover], region: NDArray[np.bool_]) -> SurveyEstimate:
    """Return the area of oysters in a region of fine cells, Shape=(FY, FX), with its interval.

    The area is the middle of what was seen and what may be: gaps hide oysters and floor alike, in an unknown share that
    is taken as equally likely between none and all (standard deviation: range / sqrt(12)). The error of sampling is
    that of the delete-a-group jackknife. Edges of shells add a share of the area (`EDGE`), a calibrated
    network the error that it had on other reefs. All together, times 1.96, are the interval. Without a calibration it
    knows nothing of wrong masks.
    """
    unit = FINE_M**2
    low, high = (float(part[region].sum(dtype=np.float64)) * unit for part in (cover.seen, cover.filled))
    middle, unknown = 0.5 * (low + high), (high - low) / math.sqrt(12.0)
    replicates = np.array(
        [0.5 * unit * float(one.seen[region].sum(dtype=np.float64) + one.filled[region].sum(dtype=np.float64))
         for one in without]
    )  # fmt: skip
    count = len(replicates)
    sampling = 0.0 if count < 2 else (count - 1) / count * float(((replicates - replicates.mean()) ** 2).sum())
    network = 0.0 if cover.calibration is None else cover.calibration.std_m2(middle)
    error = math.sqrt(unknown**2 + sampling + (EDGE * middle) ** 2 + network**2)
    return SurveyEstimate.around(middle, error)


def fine_of(cells: NDArray[np.bool_], cell_m: float, cover: Cover) -> NDArray[np.bool_]:
    """Return a mask of map cells, Shape=(NY, NX), on the fine cells, Shape=(FY, FX)."""
    return cells[np.ix_(*larger_cells(cover.seen.shape, cells.shape, cell_m))]


def larger_cells(shape: tuple[int, ...], larger: tuple[int, ...], cell_m: float) -> tuple[NDArray[np.intp], ...]:
    """Return the row of the larger cells in which each row of fine cells lies, and the same of the columns.

    Shape=(FY,), (FX,).
    """
    return tuple(
        np.minimum(((np.arange(fine) + 0.5) * FINE_M / cell_m).astype(np.intp), cells - 1)
        for fine, cells in zip(shape, larger, strict=True)
    )


def make_cover(votes: Votes, calibration: CoverCalibration | None = None) -> Cover:
    """Return the cover that votes mean."""
    share, hit, nearest, known = locate_gaps(votes)
    if calibration is not None:
        share = np.where(hit, calibration.apply(share, votes.nearest_m), np.float32(0.0))
    return Cover(share, np.where(known, share.ravel()[nearest], np.float32(0.0)), known, calibration)


def locate_gaps(
    votes: Votes,
) -> tuple[NDArray[np.float32], NDArray[np.bool_], NDArray[np.intp], NDArray[np.bool_]]:
    """Return the share of oysters in the votes, where there are some, the nearest such cell, and what is near enough.

    Shape=(FY, FX) each; the nearest cell is an index into the flat array.
    """
    total = votes.oyster + votes.floor
    hit = np.asarray(total > 1e-4)  # a difference of sums of float32 may leave a speck
    share = np.where(hit, np.clip(votes.oyster / np.maximum(total, 1e-4), 0.0, 1.0), 0.0).astype(np.float32)
    if not hit.any():
        return share, hit, np.zeros(hit.shape, np.intp), hit
    away, nearest = nearest_in(hit)
    return share, hit, nearest, np.asarray(away * FINE_M <= GAP_M)


def nearest_in(mask: NDArray[np.bool_]) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
    """Return the distance (cells) of every cell to the nearest one of a mask, and that as an index into the flat array.

    Shape=(NY, NX) each; the mask has a cell.
    """
    away, label = cv2.distanceTransformWithLabels(
        (~mask).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    cell_of = np.zeros(int(label.max()) + 1, np.intp)
    cell_of[label[mask]] = np.flatnonzero(mask)
    return np.asarray(away, np.float32), cell_of[label]


@dataclass(frozen=True)
class CoverCalibration:
    """The true cover of fine cells by share of votes and distance, measured on reefs whose truth is known."""

    cover: tuple[float, ...]
    """Mean true cover of each bin of `bins_of`, shells included that a survey misses. Length `BINS`."""
    common: float
    """Relative standard deviation of an area of oysters that all parts of a reef share."""
    patch_m: float
    """Square root of an area (m): parts of a reef err independently, with standard deviation patch_m sqrt(area)."""
    reefs: int
    """Number of reefs that it was measured on."""
    made_by: str
    """Command that made it."""

    def apply(self, share: NDArray[np.float32], nearest_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the expected cover of fine cells by the share of oysters among the votes and the nearest depth."""
        return np.asarray(self.cover, np.float32)[bins_of(share, nearest_m)]

    def std_m2(self, area_m2: float) -> float:
        """Return the standard deviation of an area of oysters by errors of the network (m²).

        It is that of a reef which was left out of the calibration; the 1 / n is the error of the calibration itself.
        """
        variance = (self.common * area_m2) ** 2 + self.patch_m**2 * max(area_m2, 0.0)
        return math.sqrt((1.0 + 1.0 / max(self.reefs, 1)) * variance)


def bins_of(share: NDArray[np.float32], nearest_m: NDArray[np.float32]) -> NDArray[np.intp]:
    """Return the number of the bin of each fine cell, 0 to BINS - 1."""
    return np.digitize(share, SHARES) * (len(DEPTHS_M) + 1) + np.digitize(nearest_m, DEPTHS_M)


def find_calibration(perception: str) -> CoverCalibration | None:
    """Return the calibration of a network by its name in a recording; None where there is none.

    Only the shipped network for painted reefs has one: of others the true cover is not known.
    """
    if perception != PAINTED:
        return None
    values = read_json(SHIPPED.with_suffix(".cover.json"), "a calibration")
    return CoverCalibration(**{**values, "cover": tuple(values["cover"])})
