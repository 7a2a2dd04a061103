"""How well eyes see: overlap of classes and error of depth, by range."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.perception import SeenPicture
from coral.reef.paint.labelled_pictures import UNKNOWN, LabelledPicture
from coral.reef.world.geometry import Frame, Label

BANDS_M = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0)
"""Edges of the bands of range."""
_PLACES = 2000
"""Depth errors and doubts kept of each picture and band."""


@dataclass
class EyesScore:
    """Counts over pictures: add pictures, then read the shares.

    A pixel belongs to the band of its true range, so an oyster that is seen where there is none counts in the band of
    what is really there. Pixels that are too doubtful for the map should be water in `SeenPicture`.
    """

    counts: NDArray[np.int64] = field(
        default_factory=lambda: np.zeros((len(BANDS_M) - 1, len(Label), len(Label)), np.int64)
    )
    """Pixels by band, class seen and true class."""
    errors: list[list[NDArray[np.float32]]] = field(default_factory=lambda: [[] for _ in BANDS_M[1:]])
    doubts: list[list[NDArray[np.float32]]] = field(default_factory=lambda: [[] for _ in BANDS_M[1:]])
    pictures: int = 0

    def add(self, seen: SeenPicture, truth: Frame, lengths: NDArray[np.float64]) -> None:
        """Count what eyes say of a picture against what is true; `lengths` are those of `ray_lengths`."""
        reach = truth.depth * lengths
        self.pictures += 1
        for band, (low, high) in enumerate(pairwise(BANDS_M)):
            here = (reach >= low) & (reach < high)
            np.add.at(self.counts[band], (seen.labels[here], truth.labels[here]), 1)
            both = np.isfinite(seen.depth[here])
            error = np.abs(seen.depth[here][both] / truth.depth[here][both] - 1.0)
            self.errors[band].append(_some(error))
            floor = here & (seen.labels == Label.SEABED) & (truth.labels == Label.SEABED)
            self.doubts[band].append(_some(seen.doubt[floor]))

    def overlap(self, label: Label, until_m: float | None = None) -> list[float | None]:
        """Return the intersection over union by band, or of all bands up to a range together; None without pixels."""
        counts = self.counts
        if until_m is not None:
            counts = counts[: BANDS_M.index(until_m)].sum(axis=0, keepdims=True)
        common = counts[:, label, label]
        return _shares(common, counts[:, label].sum(axis=1) + counts[:, :, label].sum(axis=1) - common)

    def recall(self, label: Label) -> list[float | None]:
        """Return the share of a class's pixels that are found, by band."""
        return _shares(self.counts[:, label, label], self.counts[:, :, label].sum(axis=1))

    def depth_error(self) -> list[float | None]:
        """Return the median error of the depth as a share of it, by band."""
        return _medians(self.errors)

    def floor_doubt(self) -> list[float | None]:
        """Return the median doubt of the sea floor that is seen as such, by band: how far the eyes see shows in it."""
        return _medians(self.doubts)


def video_rows(
    seen: Iterable[tuple[LabelledPicture, NDArray[np.bool_], NDArray[Any]]],
) -> list[dict[str, Any]]:
    """Return IoU, precision and recall of the oyster pixels by video.

    Each picture comes with what eyes call oyster in it and how probable that is, in their size, Shape=(H, W). A box
    counts whole; pixels between points do not count. `said` and `true` are the shares of oysters by the probabilities
    and by the outlines.
    """
    counts: dict[str, NDArray[np.float64]] = {}
    for one, said, likely in seen:
        target = cv2.resize(one.target, said.shape[::-1], interpolation=cv2.INTER_NEAREST)
        true = (target == int(Label.OYSTER)) | ((target == UNKNOWN) & (not one.of_points))
        known = (target != UNKNOWN) | (not one.of_points)
        found = [(said & true).sum(), (said & known).sum(), true.sum(), likely[known].sum(), known.sum()]
        counts[one.video] = counts.get(one.video, np.zeros(5)) + np.array(found, np.float64)
    return [
        {
            "video": video,
            "iou": round(both / max(said + true - both, 1), 3),
            "precision": round(both / max(said, 1), 3),
            "recall": round(both / max(true, 1), 3),
            "said": round(likely / max(pixels, 1), 3),
            "true": round(true / max(pixels, 1), 3),
        }
        for video, (both, said, true, likely, pixels) in sorted((one, row.tolist()) for one, row in counts.items())
    ]


def _some(values: NDArray[Any]) -> NDArray[np.float32]:
    return values[:: max(1, len(values) // _PLACES)].astype(np.float32)


def _medians(bands: list[list[NDArray[np.float32]]]) -> list[float | None]:
    kept = [np.concatenate(band) if band else np.zeros(0) for band in bands]
    return [round(float(np.median(band)), 3) if len(band) else None for band in kept]


def _shares(parts: NDArray[np.int64], wholes: NDArray[np.int64]) -> list[float | None]:
    return [round(float(part / whole), 3) if whole else None for part, whole in zip(parts, wholes, strict=True)]
