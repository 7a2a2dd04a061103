"""What pictures leave possible of an area of oysters, where they are doubtful, not to be judged, or too few."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.perception import is_judged
from coral.reef.products.cover import (
    ANY_DOUBT,
    FINE_M,
    RANGE_M,
    Cover,
    SurveyEstimate,
    Votes,
    collect_votes,
    fine_of,
    larger_cells,
    make_cover,
    oyster_probability,
    sum_votes,
    vote,
    with_doubt,
)
from coral.reef.products.seen_points import find_points, grid_shape
from coral.reef.recordings.recording import EXACT, RECORDED, Recording

SURE = 0.05
"""Doubt up to which an oyster counts for the lower end of an interval."""
ENOUGH = 0.5
"""Share of pictures that must be like those that the network was trained on."""
FEW = 2
"""A place has too few pictures if they are fewer than so many times those that must show oysters there: one that shows
none can then be what keeps it from counting."""


@dataclass(frozen=True)
class PossibleCover:
    """What may be in every fine cell. Shape=(FY, FX) each."""

    possible: NDArray[np.float32]
    """Share of oysters, however doubtful."""
    left_out: NDArray[np.bool_]
    """Cells that do not count, seen in too few pictures for oysters to count there."""
    unjudged: NDArray[np.bool_]
    """Ground that only pictures show which nobody should judge."""
    sure: NDArray[np.float32] | None
    """Share of oysters without much doubt; None where the errors of the network are known, or it has none."""

    def widen(self, area: SurveyEstimate, region: NDArray[np.bool_]) -> SurveyEstimate:
        """Return the area of a region of fine cells, Shape=(FY, FX), with what may be there in its interval."""
        high = max(area.high, area.value + self._sum(self.possible, region & self.left_out))
        low = area.low
        if self.sure is not None:
            low = min(low, self._sum(self.sure, region))
            high = max(high, self._sum(self.possible, region))
        return SurveyEstimate(area.value, low, high + self._sum(self.unjudged, region))

    def _sum(self, share: NDArray[np.float32] | NDArray[np.bool_], region: NDArray[np.bool_]) -> float:
        return float(share[region].sum(dtype=np.float64)) * FINE_M**2


@dataclass(frozen=True)
class Judgement:
    """What pictures of a survey may say of its oysters."""

    pictures: int
    unlike: int
    """Pictures unlike all that the network was trained on: they are no evidence of oysters or of sea floor."""

    @property
    def judged(self) -> bool:
        """Whether the survey may be judged."""
        return self.unlike <= (1.0 - ENOUGH) * self.pictures

    def warning(self) -> str:
        """Return what leads every headline where the survey was not judged, else nothing."""
        if self.judged:
            return ""
        return f"Not judged: {self.unlike} of {self.pictures} pictures are unlike all that the network was trained on"


def judge(recording: Recording, whole: Cover, counted: NDArray[np.bool_]) -> tuple[Judgement, PossibleCover]:
    """Judge the pictures of a located recording, and find what they leave possible.

    `whole` is its cover by `measure_cover`, of which the fine cells `counted`, Shape=(FY, FX), make the area.
    """
    wide = with_doubt(recording, ANY_DOUBT)
    shape, cell_m = grid_shape(recording, FINE_M), recording.map.cell_m
    known, unknown = np.zeros(shape, np.bool_), np.zeros(shape, np.bool_)
    votes = Votes.none(shape)
    looks = np.zeros(grid_shape(recording, cell_m), np.uint16)
    iy, ix = larger_cells(shape, looks.shape, cell_m)
    pictures = unlike = 0
    network = recording.seen_by not in (RECORDED, EXACT)
    for keyframe in recording.keyframes():
        judged = not network or is_judged(keyframe.frame)
        pictures, unlike = pictures + 1, unlike + (not judged)
        points = find_points(keyframe, wide, FINE_M, shape, RANGE_M)
        likely = oyster_probability(points.frame, soft=False)
        at = np.unravel_index(np.unique(points.cell[~np.isnan(likely) & (points.cell >= 0)]), shape)
        (known if judged else unknown)[at] = True
        if judged:
            vote(points.cell, points.frame.depth, likely, votes)
            seen = np.zeros(looks.shape, np.bool_)
            seen[iy[at[0]], ix[at[1]]] = True
            looks += seen
    return Judgement(pictures, unlike), PossibleCover(
        possible=make_cover(votes).filled,
        left_out=~counted & fine_of(looks < FEW * recording.map.target_hits, cell_m, whole),
        unjudged=unknown & ~known,
        sure=_sure(recording) if network and whole.calibration is None else None,
    )


def _sure(recording: Recording) -> NDArray[np.float32]:
    surer = with_doubt(recording, replace(recording.map.doubt, oyster=SURE))
    return make_cover(sum_votes(collect_votes(surer, soft=False))).filled
