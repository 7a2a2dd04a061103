"""How well each part of the sea floor was seen: distance, size of a pixel, number of looks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.products.cover_kernels import look
from coral.reef.products.seen_points import find_points, grid_shape
from coral.reef.recordings.recording import Recording


@dataclass(frozen=True)
class ViewQuality:
    """Arrays over the map's cells."""

    nearest_m: NDArray[np.float32]
    """Smallest distance along the line of sight (m), inf where not seen. Shape=(NY, NX)."""
    looks: NDArray[np.uint16]
    """Number of pictures that show the cell. Shape=(NY, NX)."""

    def pixel_m(self, focal_px: float) -> NDArray[np.float32]:
        """Return the size of a pixel at the smallest distance, across the line of sight (m). Shape=(NY, NX)."""
        return np.asarray(self.nearest_m / np.float32(focal_px), np.float32)


def measure_views(recording: Recording) -> ViewQuality:
    """Go through all pictures of a located recording, within the map's range."""
    cell_m = recording.map.cell_m
    shape = grid_shape(recording, cell_m)
    nearest, looks = np.full(shape, np.inf, np.float32), np.zeros(shape, np.uint16)
    last = np.zeros(shape, np.int32)
    for number, keyframe in enumerate(recording.keyframes(), 1):
        points = find_points(keyframe, recording, cell_m, shape, recording.map.range_m)
        look(points.cell, points.away, points.frame.labels, nearest, looks, last, number)
    return ViewQuality(nearest, looks)
