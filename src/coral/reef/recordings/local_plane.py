"""A plane in metres about a place on Earth (WGS 84), x east and y north there."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, install_extra

MOST_DEGREES = 84.0
"""UTM ends there."""


class LocalPlane:
    """Converts between local metres, degrees and UTM.

    The plane is the transverse Mercator projection about the place itself, with scale 1: true to angles, and to lengths
    within one part in 10^8 over a kilometre. UTM's own scale differs by up to one part in 1000.
    """

    def __init__(self, latitude: float, longitude: float) -> None:
        """Put the plane's origin at a latitude and a longitude (degrees)."""
        self.latitude, self.longitude = latitude, longitude

    @property
    def epsg(self) -> int:
        """EPSG code of the UTM zone."""
        zone = min(math.floor((self.longitude + 180.0) / 6.0) + 1, 60)
        return (32600 if self.latitude >= 0.0 else 32700) + zone

    def to_degrees(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[Any, Any]:
        """Return latitudes and longitudes (degrees) of points (m). All of one shape."""
        longitude, latitude = self._local(x, y, inverse=True)
        return latitude, longitude

    def from_degrees(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return the place of a point in degrees (m)."""
        x, y = self._local(longitude, latitude)
        return float(x), float(y)

    def to_utm(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[Any, Any]:
        """Return easting and northing in the UTM zone (m) of points (m). All of one shape."""
        latitude, longitude = self.to_degrees(x, y)
        easting, northing = self._utm(longitude, latitude)
        return easting, northing

    def from_utm(self, easting: NDArray[np.float64], northing: NDArray[np.float64]) -> tuple[Any, Any]:
        """Return the places (m) of points given in UTM (m). All of one shape."""
        longitude, latitude = self._utm(easting, northing, inverse=True)
        x, y = self._local(longitude, latitude)
        return x, y

    @cached_property
    def _local(self) -> Any:
        return _projection(f"+proj=tmerc +lat_0={self.latitude!r} +lon_0={self.longitude!r} +k=1 +ellps=WGS84")

    @cached_property
    def _utm(self) -> Any:
        return _projection(f"EPSG:{self.epsg}")


def _projection(definition: str) -> Any:
    try:
        from pyproj import Proj
    except ImportError:
        raise InputError("coordinates", "", "no package pyproj", install_extra("geo")) from None
    return Proj(definition)
