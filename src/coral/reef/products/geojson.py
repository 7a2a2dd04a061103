"""GeoJSON (RFC 7946): features in longitude and latitude, WGS 84."""

from __future__ import annotations

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
        rings = [_degrees(ring, placement, closed=True) for ring in feature.rings]
        return {"type": layer.kind, "coordinates": [[ring] for ring in rings]}
    line = _degrees(feature.rings[0], placement, closed=False)
    return {"type": layer.kind, "coordinates": line[0] if layer.kind == "Point" else line}


def _degrees(points: NDArray[np.float64], placement: EarthPlacement, *, closed: bool) -> list[list[float]]:
    latitude, longitude = placement.to_degrees(points[:, 0], points[:, 1])
    degrees = np.stack([longitude, latitude], axis=1)
    corners: list[list[float]] = np.round(closed_ring(degrees) if closed else degrees, DIGITS).tolist()
    return corners
