"""Calibration of a network's oysters: what share of the sea floor shells truly cover where it votes for oysters."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.foreign_file import read_json
from coral.reef.eyes.backends import PAINTED
from coral.reef.eyes.reef_net import SHIPPED

SHARES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)
"""Edges between bins of the share of votes. Most cells are near 0 or 1."""
DEPTHS_M = (0.8, 1.0, 1.2, 1.4, 1.6, 2.0, 2.5)
"""Edges between bins of the depth of the nearest pixel (m)."""
BINS = (len(SHARES) + 1) * (len(DEPTHS_M) + 1)


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
