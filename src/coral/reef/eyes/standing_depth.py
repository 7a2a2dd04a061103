"""Metric depth from classes and height alone: things stand on a flat sea floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Label


def standing_depth(labels: NDArray[np.uint8], ground: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the depth of every pixel (m), if what is seen lies on the sea floor or stands upright on it. Shape=(H, W).

    Sea floor and oysters have the depth of the plane, `ground_depth`. An obstacle has in each column the depth of the
    plane at its lowest pixel, its foot; above the horizon without a foot, as a floating ball, it has none. Inf for
    water and where nothing is known.
    """
    depth = np.where((labels == Label.SEABED) | (labels == Label.OYSTER), ground, np.float32(np.inf))
    foot = np.full(labels.shape[1], np.inf, np.float32)
    below = np.zeros(labels.shape[1], np.bool_)
    for row in range(labels.shape[0] - 1, -1, -1):
        hit = labels[row] == Label.OBSTACLE
        foot = np.where(hit & ~below, ground[row], foot)
        depth[row] = np.where(hit, foot, depth[row])
        below = hit
    return depth.astype(np.float32)
