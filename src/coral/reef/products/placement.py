"""Where a survey lies on Earth: a datum given at the start, and rasters placed by it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.recordings.local_plane import MOST_DEGREES, LocalPlane
from coral.reef.world.geometry import Pose


@dataclass(frozen=True)
class Datum:
    """Where the start of a survey is (WGS 84)."""

    latitude: float
    longitude: float
    """Degrees."""
    heading: float | None = None
    """Compass heading of the vehicle at the start (degrees, clockwise from true north). None: the recording's x axis
    points east, as that of a vehicle with a compass."""


def parse_datum(text: str) -> Datum:
    """Read LAT,LON or LAT,LON,HEADING in degrees.

    Raises:
        InputError: It is something else.
    """
    expected = f"LAT,LON or LAT,LON,HEADING in degrees; latitudes within {MOST_DEGREES:.0f}, longitudes within 180"
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    sound = len(values) in (2, 3) and all(map(math.isfinite, values))
    if not sound or abs(values[0]) > MOST_DEGREES or abs(values[1]) > 180.0 or not -360.0 <= ([*values, 0.0])[2] <= 360:
        raise InputError("--datum", "", repr(text), expected)
    return Datum(*values)


@dataclass(frozen=True)
class EarthPlacement:
    """From the metres of a located recording to places on Earth; without a datum they stay metres of the recording."""

    start: Pose
    datum: Datum | None = None

    @property
    def epsg(self) -> int | None:
        """EPSG code of the coordinates of rasters and layers; None without a datum."""
        return None if self.datum is None else self._plane.epsg

    def to_output(self, x: Any, y: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return UTM easting and northing of points (m), or the points themselves without a datum."""
        if self.datum is None:
            return np.asarray(x, float), np.asarray(y, float)
        east, north = self._turned(np.asarray(x) - self.start.x, np.asarray(y) - self.start.y, self._turn)
        return self._plane.to_utm(east, north)

    def from_output(self, x: Any, y: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The inverse of `to_output`."""
        if self.datum is None:
            return np.asarray(x, float), np.asarray(y, float)
        east, north = self._plane.from_utm(np.asarray(x, float), np.asarray(y, float))
        x, y = self._turned(np.asarray(east), np.asarray(north), -self._turn)
        return x + self.start.x, y + self.start.y

    def to_degrees(self, x: Any, y: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return latitudes and longitudes of points (m). Only with a datum."""
        assert self.datum is not None
        east, north = self._turned(np.asarray(x) - self.start.x, np.asarray(y) - self.start.y, self._turn)
        return self._plane.to_degrees(east, north)

    @cached_property
    def _plane(self) -> LocalPlane:
        assert self.datum is not None
        return LocalPlane(self.datum.latitude, self.datum.longitude)

    @property
    def _turn(self) -> float:
        """Angle from the recording's frame to east and north (rad)."""
        assert self.datum is not None
        heading = self.datum.heading
        return 0.0 if heading is None else math.radians(90.0 - heading) - self.start.theta

    @staticmethod
    def _turned(
        x: NDArray[np.float64], y: NDArray[np.float64], angle: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        c, s = math.cos(angle), math.sin(angle)
        return c * x - s * y, s * x + c * y


@dataclass(frozen=True)
class PlacedRaster:
    """A raster with north up."""

    values: NDArray[Any]
    """Shape=(H, W) or (H, W, C), first row in the north."""
    west: float
    north: float
    """Output coordinates of the outer corner of the first pixel (m)."""
    pixel_m: float


def place_raster(values: NDArray[Any], cell_m: float, placement: EarthPlacement, nothing: Any) -> PlacedRaster:
    """Place a grid of the map, Shape=(NY, NX) or (NY, NX, C), in output coordinates; `nothing` stands outside the map.

    Each pixel takes the value of the cell at its centre, and is as large as a cell (m).
    """
    ny, nx = values.shape[:2]
    if placement.datum is None:
        return PlacedRaster(np.ascontiguousarray(values[::-1]), 0.0, ny * cell_m, cell_m)
    edge_x, edge_y = nx * cell_m, ny * cell_m
    corners = placement.to_output([0.0, edge_x, edge_x, 0.0], [0.0, 0.0, edge_y, edge_y])
    west, east = (math.floor(corners[0].min() / cell_m) * cell_m, corners[0].max())
    north, south = (math.ceil(corners[1].max() / cell_m) * cell_m, corners[1].min())
    width, height = math.ceil((east - west) / cell_m), math.ceil((north - south) / cell_m)
    out = np.full((height, width, *values.shape[2:]), nothing, values.dtype)
    across = west + (np.arange(width) + 0.5) * cell_m
    for row in range(height):
        x, y = placement.from_output(across, np.full(width, north - (row + 0.5) * cell_m))
        ix, iy = np.floor(x / cell_m).astype(np.int64), np.floor(y / cell_m).astype(np.int64)
        inside = (ix >= 0) & (iy >= 0) & (ix < nx) & (iy < ny)
        out[row, inside] = values[iy[inside], ix[inside]]
    return PlacedRaster(out, west, north, cell_m)
