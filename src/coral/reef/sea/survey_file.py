"""A survey file: the area of a real survey, its geofence, and where the vehicle must not go.

Frame: local metres from the south-west corner of the area, x east, y north. With an `origin`, also degrees.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from coral.config import read_yaml
from coral.errors import InputError
from coral.foreign_file import regular_bytes
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld, Start
from coral.validation_errors import input_error

FORMAT: Literal["coral-survey/1"] = "coral-survey/1"
EARTH_RADIUS_M = 6_371_008.8
"""Mean radius. Over 100 m a local plane on this sphere is within 0.4 m of the ellipsoid."""
HULL_M = 0.3

Edge = Annotated[float, Field(gt=1, le=100, strict=False)]
Metres = Annotated[float, Field(ge=-1000, le=1000)]
Latitude = Annotated[float, Field(ge=-85, le=85)]
Longitude = Annotated[float, Field(ge=-180, le=180)]
Ring = tuple[tuple[float, float], ...]
Corner = tuple[float, float]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Origin(_Part):
    """Where the area's south-west corner is on Earth (WGS 84, degrees)."""

    latitude: Latitude
    longitude: Longitude
    """In degrees."""

    def to_local(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Convert a place in degrees to local metres (east, north)."""
        north = math.radians(latitude - self.latitude) * EARTH_RADIUS_M
        turned = (longitude - self.longitude + 180.0) % 360.0 - 180.0  # the date line is no border
        east = math.radians(turned) * EARTH_RADIUS_M * math.cos(math.radians(self.latitude))
        return east, north

    def to_degrees(self, east: float, north: float) -> tuple[float, float]:
        """Convert local metres to latitude and longitude."""
        turned = math.degrees(east / (EARTH_RADIUS_M * math.cos(math.radians(self.latitude))))
        return self.latitude + math.degrees(north / EARTH_RADIUS_M), (self.longitude + turned + 180.0) % 360.0 - 180.0


class Polygon(_Part):
    """An outline, in local metres or in degrees."""

    name: str = Field(default="", max_length=60)
    """For messages and maps."""
    metres: Annotated[tuple[tuple[Metres, Metres], ...], Field(min_length=3, max_length=200)] | None = None
    """Corners (x, y) in order."""
    degrees: Annotated[tuple[tuple[Latitude, Longitude], ...], Field(min_length=3, max_length=200)] | None = None
    """Corners (latitude, longitude) in order."""


class SurveyFile(_Part):
    """What a real survey needs to know beforehand."""

    format: Literal["coral-survey/1"] = FORMAT
    """May be left out."""
    name: str = Field(min_length=1, max_length=60)
    """At most 60 characters."""
    size_m: tuple[Edge, Edge]
    """Extent of the area to the east and to the north (m), at most 100 each."""
    origin: Origin | None = None
    """Its south-west corner on Earth; without it, outlines are in metres."""
    start: Start
    """Where the vehicle is put into the water, and its heading (rad, counter-clockwise from east)."""
    depth_m: Annotated[float, Field(gt=0, le=100)] = 1.0
    """Depth to hold, below the surface."""
    geofence: Polygon | None = None
    """The vehicle must stay inside; by default the whole area."""
    keep_out: Annotated[tuple[Polygon, ...], Field(max_length=50)] = ()
    """Where it must not go, outlines like the geofence."""
    rehearse: str | None = None
    """World to rehearse in, with a simulated vehicle; by default there is nothing in the water."""


@dataclass(frozen=True)
class SurveyArea:
    """A survey's area in local metres, with its outlines checked."""

    name: str
    size_m: tuple[float, float]
    start: Pose
    fence: Ring
    keep_out: tuple[tuple[str, Ring], ...] = ()
    origin: Origin | None = None

    @classmethod
    def of_world(cls, world: ReefWorld) -> SurveyArea:
        """Take the area of a simulated reef; its border is the fence."""
        return cls(
            world.name, world.size_m, Pose(world.start.x, world.start.y, world.start.theta), _border(world.size_m)
        )

    def begun_at(self, start: tuple[float, float, float], where: str) -> SurveyArea:
        """Return the same area with another start: x, y (m), heading (rad).

        Raises:
            InputError: No hull fits there.
        """
        area = replace(self, start=Pose(*start))
        check_start(area, where, "")
        return area

    def breach(self, x: float, y: float) -> str:
        """Return what a position (m) violates, in words, or ""."""
        if not contains_point(self.fence, x, y):
            return "outside the geofence"
        return next((f"inside keep-out {name!r}" for name, ring in self.keep_out if contains_point(ring, x, y)), "")

    def forbidden(self, cell_m: float, shape: tuple[int, int]) -> NDArray[np.bool_]:
        """Return the map cells outside the fence, inside a keep-out or on an outline. Shape=(NY, NX), as `shape`."""
        import cv2

        def draw(ring: Ring, inside: int, edge: int) -> NDArray[np.bool_]:
            # Cell k has its centre at (k + 0.5) cells; sub-pixel bits keep corners that lie between cells.
            corners = np.round((np.array(ring) / cell_m - 0.5) * 16).astype(np.int32)
            mask = np.full(shape, 1 - inside, np.uint8)
            cv2.fillPoly(mask, [corners], inside, shift=4)
            cv2.polylines(mask, [corners], True, edge, shift=4)
            return mask.astype(np.bool_)

        whole = self.fence == _border(self.size_m)
        closed = np.zeros(shape, np.bool_) if whole else draw(self.fence, inside=0, edge=1)
        for _, ring in self.keep_out:
            closed |= draw(ring, inside=1, edge=1)
        return closed


def read_survey(path: Path) -> tuple[SurveyArea, SurveyFile]:
    """Read and check a survey file.

    Raises:
        InputError: The file is missing or broken; an outline is given twice or not at all, crosses itself, or is in
            degrees without an origin; the start is outside the fence, within a keep-out, or too near to either.
    """
    where = str(path)
    content = read_yaml(path)
    try:
        found = SurveyFile.model_validate(content)
    except ValidationError as error:
        raise input_error(where, error, SurveyFile) from None
    border = _border(found.size_m)
    fence = border if found.geofence is None else _ring(found.geofence, found.origin, where, "geofence")
    keep_out = tuple(
        (each.name or f"keep_out[{k}]", _ring(each, found.origin, where, f"keep_out[{k}]"))
        for k, each in enumerate(found.keep_out)
    )
    start = Pose(found.start.x, found.start.y, found.start.theta)
    area = SurveyArea(found.name, found.size_m, start, fence, keep_out, found.origin)
    check_start(area, where, "start")
    return area, found


def check_start(area: SurveyArea, where: str, field: str) -> None:
    """Check that the hull fits at the start.

    Raises:
        InputError: It would be outside the area or the fence, or inside a keep-out.
    """
    start, border = area.start, _border(area.size_m)
    if not all(map(math.isfinite, start)):
        raise InputError(where, field, tuple(start), "finite numbers")
    for k in range(9):  # the start and eight points on the hull about it
        reach = HULL_M if k else 0.0
        x, y = start.x + reach * math.cos(k * math.pi / 4), start.y + reach * math.sin(k * math.pi / 4)
        if wrong := area.breach(x, y) or ("" if contains_point(border, x, y) else "outside the area"):
            raise InputError(where, field, f"({start.x:g}, {start.y:g}), {wrong}", f"a place {HULL_M:g} m inside")


def is_survey(path: Path) -> bool:
    """Check whether a file says that it is a survey file, without checking more of it."""
    try:
        return b"coral-survey/" in regular_bytes(path, 2000)
    except OSError:
        return False


def _border(size_m: tuple[float, float]) -> Ring:
    width, height = size_m
    return ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))


def _ring(outline: Polygon, origin: Origin | None, where: str, field: str) -> Ring:
    if (outline.metres is None) == (outline.degrees is None):
        found = "both metres and degrees" if outline.metres else "neither metres nor degrees"
        raise InputError(where, field, found, "one of them")
    if outline.metres is not None:
        ring: Ring = outline.metres
    else:
        if origin is None:
            raise InputError(
                where, f"{field}.degrees", "no origin in the file", "origin: {latitude: ..., longitude: ...}"
            )
        assert outline.degrees is not None
        ring = tuple(origin.to_local(latitude, longitude) for latitude, longitude in outline.degrees)
    if not is_simple(ring):
        raise InputError(where, field, "an outline that crosses itself", "corners in order along the outline")
    return ring


def contains_point(ring: Sequence[Corner], x: float, y: float) -> bool:
    """Check whether a point lies inside an outline, by the even-odd rule; corners in order, not repeated at the end."""
    inside = False
    for (ax, ay), (bx, by) in _edges(ring):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def is_simple(ring: Sequence[Corner]) -> bool:
    """Check whether an outline has an area and no two of its edges that are not neighbours touch."""
    edges = list(_edges(ring))
    area = sum(ax * by - bx * ay for (ax, ay), (bx, by) in edges)
    if abs(area) < 1e-9:
        return False
    count = len(edges)
    return not any(
        _cross(edges[i], edges[j]) for i in range(count) for j in range(i + 2, count) if not (i == 0 and j == count - 1)
    )


def _edges(ring: Sequence[Corner]) -> zip[tuple[Corner, Corner]]:
    return zip(ring, [*ring[1:], ring[0]], strict=True)


def _cross(first: tuple[Corner, Corner], second: tuple[Corner, Corner]) -> bool:
    (a, b), (c, d) = first, second
    return _side(a, b, c) * _side(a, b, d) <= 0 and _side(c, d, a) * _side(c, d, b) <= 0


def _side(a: Corner, b: Corner, point: Corner) -> int:
    turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
    return (turn > 1e-12) - (turn < -1e-12)
