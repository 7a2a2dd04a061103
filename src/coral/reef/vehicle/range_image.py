"""What an imaging sonar measures: a range for every beam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RangeImage:
    """One image of a sonar. Row 0 holds the lowest beams and column 0 the leftmost, as in the Sonar 3D-15's protocol.

    Beams are evenly spaced in azimuth and elevation, the first and the last at the edges of the field of view.
    """

    ranges: NDArray[np.float32]
    """Distance to the strongest echo along each beam (m); inf where there is none. Shape=(H, W), float32."""
    hfov_deg: float
    """Angle between the first and the last column (degrees)."""
    vfov_deg: float
    """Angle between the first and the last row (degrees)."""

    def directions(self) -> NDArray[np.float64]:
        """Return the unit vector of every beam in the sonar's frame: x forward, y left, z up. Shape=(H, W, 3)."""
        return beam_directions(self.ranges.shape, self.hfov_deg, self.vfov_deg)


def beam_angles(
    shape: tuple[int, ...], hfov_deg: float, vfov_deg: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the azimuth of each column, positive to the left, Shape=(W,), and the elevation of each row, Shape=(H,).

    They are in rad; the angles given, in degrees, are those between the first and the last column or row.
    """
    half_h, half_v = 0.5 * np.radians(hfov_deg), 0.5 * np.radians(vfov_deg)
    return np.linspace(half_h, -half_h, shape[1]), np.linspace(-half_v, half_v, shape[0])


def beam_directions(shape: tuple[int, ...], hfov_deg: float, vfov_deg: float) -> NDArray[np.float64]:
    """Return the unit vector of every beam of `beam_angles`: x forward, y left, z up. Shape=(H, W, 3)."""
    azimuth, elevation = beam_angles(shape, hfov_deg, vfov_deg)
    level = np.cos(elevation)[:, None]
    forward, left = level * np.cos(azimuth), level * np.sin(azimuth)
    up = np.broadcast_to(np.sin(elevation)[:, None], forward.shape)
    return np.ascontiguousarray(np.stack([forward, left, up], axis=-1))
