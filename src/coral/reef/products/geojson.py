"""GeoJSON (RFC 7946): features in longitude and latitude, WGS 84."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.file_writer import write_whole
from coral.reef.products.feature import Feature, Layer, closed_ring
from coral.reef.products.placement import EarthPlacement

DIGITS = 8
"""A millimetre."""


def write_geojson(path: Path, layer: Layer, placement: EarthPlacement) -> None:
    """Write a layer.

    Args:
        path: File to write; an existing one is replaced.
        layer: The features, in metres of the map.
        placement: Where the map lies, with a datum.

    Raises:
        OSError: The file cannot be written.
    """
    collection = {
        "type": "FeatureCollection",
        "name": layer.name,
        "features": [
            {"type": "Feature", "properties": feature.values, "geometry": _geometry(feature, layer, placement)}
            for feature in layer.features
        ],
    }
    write_whole(path, (json.dumps(collection, allow_nan=False) + "\n").encode())


def _geometry(feature: Feature, layer: Layer, placement: EarthPlacement) -> dict[str, Any]:
    if layer.kind == "MultiPolygon":
        rings = [part for ring in feature.rings for part in _degrees(ring, placement, closed=True)]
        return {"type": layer.kind, "coordinates": [[ring] for ring in rings]}
    if layer.kind == "Point":
        return {"type": layer.kind, "coordinates": _degrees(feature.rings[0][:1], placement, closed=False)[0][0]}
    lines = _degrees(feature.rings[0], placement, closed=False)
    if len(lines) > 1:
        return {"type": "MultiLineString", "coordinates": lines}
    return {"type": layer.kind, "coordinates": lines[0]}


def _degrees(points: NDArray[np.float64], placement: EarthPlacement, *, closed: bool) -> list[list[list[float]]]:
    """Return an outline or a line in degrees, cut in two where it crosses the date line (RFC 7946, 3.1.9)."""
    latitude, longitude = placement.to_degrees(points[:, 0], points[:, 1])
    degrees = np.stack([np.unwrap(longitude, period=360.0), latitude], axis=1)
    degrees = closed_ring(degrees) if closed else degrees
    low, high = degrees[:, 0].min(), degrees[:, 0].max()
    border = 180.0 if high > 180.0 else -180.0
    if low >= border or high <= border:
        parts = [degrees]
    elif closed:
        parts = [closed_ring(_beside(degrees, border, side)) for side in (1.0, -1.0)]
    else:
        split = _with_crossings(degrees, border)
        at = np.flatnonzero(split[:, 0] == border)
        ends = [0, *at.tolist(), len(split) - 1]
        parts = [split[a : b + 1] for a, b in itertools.pairwise(ends) if b > a]
    return [np.round(_on_earth(part), DIGITS).tolist() for part in parts]


def _with_crossings(degrees: NDArray[np.float64], border: float) -> NDArray[np.float64]:
    """Add the points where a line crosses a meridian."""
    found = [degrees[0]]
    for before, after in itertools.pairwise(degrees):
        share = (border - before[0]) / (after[0] - before[0]) if after[0] != before[0] else 0.0
        if 0.0 < share < 1.0:
            found.append(np.array([border, before[1] + share * (after[1] - before[1])]))
        found.append(after)
    return np.array(found)


def _beside(ring: NDArray[np.float64], border: float, side: float) -> NDArray[np.float64]:
    """Cut off the part of a closed outline east (side 1) or west (side -1) of a meridian (Sutherland and Hodgman)."""
    corners = _with_crossings(ring, border)
    return corners[side * (corners[:, 0] - border) <= 0.0]


def _on_earth(degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bring longitudes back to -180 to 180, all of them by the same turn."""
    turn = -360.0 if degrees[:, 0].max() > 180.0 else 360.0 if degrees[:, 0].min() < -180.0 else 0.0
    return np.asarray(degrees + np.array([turn, 0.0]))
