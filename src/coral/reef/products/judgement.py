"""What a network's doubt leaves possible of an area of oysters: pictures that nobody should judge, pixels it doubts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.eyes.perception import is_judged
from coral.reef.products.cover import Area, CoverCfg, collect_votes, make_cover, sum_votes
from coral.reef.products.seen_points import find_points, grid_shape
from coral.reef.recordings.recording import EXACT, RECORDED, Recording
from coral.reef.world.geometry import Label

SURE = 0.05
"""Doubt up to which an oyster counts for the lower end of an interval."""
ENOUGH = 0.5
"""Share of pictures that must be like those that the network was trained on."""


@dataclass(frozen=True)
class Judgement:
    """What pictures of a survey may say of its oysters."""

    pictures: int
    unlike: int
    """Pictures unlike all that the network was trained on: they are no evidence of oysters or of sea floor."""
    unjudged_m2: float = 0.0
    """Ground that only such pictures show (m²): any part of it may be oysters."""
    sure_m2: float | None = None
    possible_m2: float | None = None
    """Area of oysters without much doubt, and with any; None where the errors of the network are known, or it has
    none."""

    @property
    def judged(self) -> bool:
        """Whether the survey may be judged."""
        return self.unlike <= (1.0 - ENOUGH) * self.pictures

    def widen(self, area: Area) -> Area:
        """Return an area whose interval contains what doubt leaves possible; none at all if it was not judged."""
        low = area.low_m2 if self.sure_m2 is None else min(area.low_m2, self.sure_m2)
        high = area.high_m2 if self.possible_m2 is None else max(area.high_m2, self.possible_m2)
        return Area(area.m2, low if self.judged else 0.0, high + self.unjudged_m2)

    def warning(self) -> str:
        """Return what leads every headline where the survey was not judged, else nothing."""
        if self.judged:
            return ""
        return f"Not judged: {self.unlike} of {self.pictures} pictures are unlike all that the network was trained on"


def judge(recording: Recording, cfg: CoverCfg, *, calibrated: bool) -> Judgement:
    """Judge the pictures of a located recording; `calibrated`: the network's errors are in the interval already."""
    wide = replace(recording, map=replace(recording.map, doubt=DoubtCfg(oyster=1.0, obstacle=1.0, seabed=1.0)))
    shape = grid_shape(recording, cfg.fine_m)
    known, unknown = np.zeros(shape[0] * shape[1], np.bool_), np.zeros(shape[0] * shape[1], np.bool_)
    pictures = unlike = 0
    network = recording.seen_by not in (RECORDED, EXACT)
    for keyframe in recording.keyframes():
        pictures += 1
        if not network:
            continue
        judged = is_judged(keyframe.frame)
        unlike += not judged
        points = find_points(keyframe, wide, cfg.fine_m, shape, cfg.range_m)
        ground = (points.frame.labels == Label.OYSTER) | (points.frame.labels == Label.SEABED)
        (known if judged else unknown)[points.cell[ground & (points.cell >= 0)]] = True
    unit = cfg.fine_m**2
    only = float(np.count_nonzero(unknown & ~known)) * unit
    if not network or calibrated:
        return Judgement(pictures, unlike, only)
    sure, possible = (_area(recording, cfg, limit) for limit in (SURE, 1.0 - 1e-6))
    return Judgement(pictures, unlike, only, sure, possible)


def _area(recording: Recording, cfg: CoverCfg, limit: float) -> float:
    doubt = replace(recording.map.doubt, oyster=limit)
    votes = collect_votes(replace(recording, map=replace(recording.map, doubt=doubt)), cfg, soft=False)
    return float(make_cover(sum_votes(votes), cfg).filled.sum(dtype=np.float64)) * cfg.fine_m**2
