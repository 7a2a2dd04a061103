"""Maps as files: GeoTIFF (OGC 19-008), GeoPackage and GeoJSON (RFC 7946) by GDAL (pyogrio), tables as CSV."""

from __future__ import annotations

import csv
import io
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, install_extra
from coral.file_writer import scratch_for, write_whole
from coral.reef.products.placement import EarthPlacement, PlacedRaster

NO_PLACE = 'LOCAL_CS["metres of the recording",UNIT["metre",1]]'
"""Reference system of a map without a datum."""
_WKB = {"Point": 1, "LineString": 2, "MultiPolygon": 6}
GeometryKind = Literal["Point", "LineString", "MultiPolygon"]
Value = float | int | str | None
_SHORT, _DOUBLE, _ASCII = 3, 12, 2
_PIXEL_SCALE, _TIE_POINT, _GEO_KEYS, _GDAL_METADATA, _NO_DATA = 33550, 33922, 34735, 42112, 42113


def write_geopackage(path: Path, layers: Sequence[Layer], placement: EarthPlacement) -> None:
    """Write layers in UTM, or in metres of the recording without a datum; an existing file is replaced.

    Raises:
        InputError: pyogrio is not installed.
        OSError: The file cannot be written.
    """
    with scratch_for(path) as file:
        for k, layer in enumerate(layers):
            options = {"IDENTIFIER": layer.title}
            _write_layer(path, file, layer, placement, driver="GPKG", append=k > 0, layer_options=options)


def write_geojson(path: Path, layer: Layer, placement: EarthPlacement) -> None:
    """Write a layer in longitude and latitude (WGS 84) to a millimetre, cut where it crosses the date line.

    An existing file is replaced.

    Raises:
        InputError: pyogrio is not installed.
        OSError: The file cannot be written.
    """
    options = {"RFC7946": "YES", "COORDINATE_PRECISION": "8"}
    with scratch_for(path) as file:
        _write_layer(path, file, layer, placement, driver="GeoJSON", layer_options=options)


def _write_layer(path: Path, file: Path, layer: Layer, placement: EarthPlacement, **how: Any) -> None:
    try:
        from pyogrio import raw
    except ModuleNotFoundError:
        raise InputError(str(path), "", "no package pyogrio", install_extra("geo")) from None
    crs = NO_PLACE if placement.epsg is None else f"EPSG:{placement.epsg}"
    geometry = np.array([_wkb(layer, feature, placement) for feature in layer.features], dtype=object)
    columns, names = [_column(layer, name) for name in layer.attributes], list(layer.attributes)
    raw.write(file, geometry, columns, names, layer=layer.name, crs=crs, geometry_type=layer.kind, **how)


def _column(layer: Layer, name: str) -> NDArray[Any]:
    """Return the values of an attribute as GDAL types them: whole numbers, numbers with nan for None, or text."""
    values = [feature.values[name] for feature in layer.features]
    told = [value for value in values if value is not None]
    if told and all(isinstance(value, int) for value in told) and len(told) == len(values):
        return np.array(values, dtype=np.int64)
    if told and isinstance(told[0], str):
        return np.array(values, dtype=object)
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def _wkb(layer: Layer, feature: Feature, placement: EarthPlacement) -> bytes:
    """Return a geometry as well-known binary, little endian."""
    rings = [np.stack(placement.to_output(ring[:, 0], ring[:, 1]), axis=1) for ring in feature.rings]
    kind = struct.pack("<BI", 1, _WKB[layer.kind])
    if layer.kind == "Point":
        return kind + bytes(rings[0][0].astype("<f8").tobytes())
    if layer.kind == "LineString":
        return kind + _points(rings[0])
    parts = [struct.pack("<BII", 1, 3, 1) + _points(closed_ring(ring)) for ring in rings]
    return kind + struct.pack("<I", len(parts)) + b"".join(parts)


def _points(ring: NDArray[np.float64]) -> bytes:
    return struct.pack("<I", len(ring)) + bytes(ring.astype("<f8").tobytes())


@dataclass(frozen=True)
class Feature:
    """One thing on a map."""

    rings: tuple[NDArray[np.float64], ...]
    """A point or a line, or the closed outlines of a multipolygon's parts, in metres. Shape=(N, 2) each."""
    values: dict[str, Value]


@dataclass(frozen=True)
class Layer:
    """Features of one kind, all with the same attributes."""

    name: str
    title: str
    kind: GeometryKind
    features: tuple[Feature, ...]
    attributes: tuple[str, ...]
    """Their names."""


def closed_ring(ring: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a polygon's outline closed and counter-clockwise, as RFC 7946 wants outer rings. Shape=(N, 2)."""
    if not np.array_equal(ring[0], ring[-1]):
        ring = np.concatenate([ring, ring[:1]])
    x, y = ring[:, 0], ring[:, 1]
    area = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return ring if area >= 0.0 else ring[::-1].copy()


def write_table(path: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Value]]) -> None:
    """Write a CSV file.

    Raises:
        OSError: The file cannot be written.
    """
    text = io.StringIO()
    table = csv.DictWriter(text, columns, lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    write_whole(path, text.getvalue().encode())


def write_geotiff(
    path: Path, raster: PlacedRaster, epsg: int | None, *, bands: Sequence[str] = (), nothing: float | None = None
) -> None:
    """Write a raster, Shape=(H, W), (H, W, C), or red, green, blue, alpha as uint8, compressed without loss.

    `epsg` is the code of the projected coordinates; None: metres of no known place. `nothing` stands for no value.

    Raises:
        InputError: tifffile is not installed.
        OSError: The file cannot be written.
    """
    try:
        import tifffile
    except ImportError:
        raise InputError(str(path), "", "no package tifffile", install_extra("geo")) from None
    values = raster.values
    colour = values.dtype == np.uint8 and values.ndim == 3
    options: dict[str, Any] = {"photometric": "rgb", "extrasamples": ["unassalpha"]} if colour else {}
    if not colour:
        options["photometric"] = "minisblack"
        if values.ndim == 3 and values.shape[2] == 1:
            values = np.ascontiguousarray(values[:, :, 0])
        elif values.ndim == 3:
            values, options["planarconfig"] = np.ascontiguousarray(np.moveaxis(values, 2, 0)), "separate"
    scale = (raster.pixel_m, raster.pixel_m, 0.0)
    tie = (0.0, 0.0, 0.0, raster.west, raster.north, 0.0)
    # GTModelType projected, GTRasterType pixel is area, ProjectedCRS.
    keys = [(1024, 0, 1, 1), (1025, 0, 1, 1), (3072, 0, 1, epsg)] if epsg else [(1025, 0, 1, 1)]
    directory = [1, 1, 0, len(keys), *(number for key in keys for number in key)]
    tags: list[tuple[int, int, int, Any, bool]] = [
        (_PIXEL_SCALE, _DOUBLE, 3, scale, True),
        (_TIE_POINT, _DOUBLE, 6, tie, True),
        (_GEO_KEYS, _SHORT, len(directory), directory, True),
    ]
    if bands:
        items = "".join(
            f'<Item name="DESCRIPTION" sample="{k}" role="description">{escape(name)}</Item>'
            for k, name in enumerate(bands)
        )
        tags.append((_GDAL_METADATA, _ASCII, 0, f"<GDALMetadata>{items}</GDALMetadata>", True))
    if nothing is not None:
        tags.append((_NO_DATA, _ASCII, 0, f"{nothing:g}", True))
    content = io.BytesIO()
    with tifffile.TiffWriter(content) as tiff:
        tiff.write(values, compression="zlib", tile=(256, 256), metadata=None, extratags=tags, **options)
    write_whole(path, content.getvalue())
