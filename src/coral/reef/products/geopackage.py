"""GeoPackage (OGC 12-128, version 1.3): layers of features in one SQLite file."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.file_writer import scratch_for
from coral.reef.products.feature import Feature, Layer, closed_ring
from coral.reef.products.placement import EarthPlacement

_APPLICATION_ID = 0x47504B47  # "GPKG"
_VERSION = 10300
_CARTESIAN = -1
"""srs_id of metres of no known place."""
_WKB = {"Point": 1, "LineString": 2, "MultiPolygon": 6}
_TABLES = """
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
  organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '', last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
  srs_id INTEGER, CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
"""
_STYLES = """
CREATE TABLE layer_styles (id INTEGER PRIMARY KEY AUTOINCREMENT, f_table_catalog TEXT, f_table_schema TEXT,
  f_table_name TEXT, f_geometry_column TEXT, styleName TEXT, styleQML TEXT, styleSLD TEXT, useAsDefault BOOLEAN,
  description TEXT, owner TEXT, ui TEXT, update_time DATETIME DEFAULT CURRENT_TIMESTAMP);
"""
"""Where QGIS keeps the styles of a database's layers."""


def write_geopackage(path: Path, layers: Sequence[Layer], placement: EarthPlacement) -> None:
    """Write layers in UTM, or in metres of the recording without a datum.

    Args:
        path: File to write; an existing one is replaced.
        layers: The features, in metres of the map.
        placement: Where the map lies.

    Raises:
        OSError: The file cannot be written.
    """
    with scratch_for(path) as scratch:
        try:
            _write(scratch, layers, placement)
        except sqlite3.Error as error:
            raise OSError(5, str(error), str(path)) from None


def _write(path: Path, layers: Sequence[Layer], placement: EarthPlacement) -> None:
    srs = placement.epsg or _CARTESIAN
    base = sqlite3.connect(path)
    try:
        base.execute(f"PRAGMA application_id = {_APPLICATION_ID}")
        base.execute(f"PRAGMA user_version = {_VERSION}")
        base.executescript(_TABLES)
        base.executemany("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, ?)", _reference_systems(placement))
        for layer in layers:
            _add(base, layer, placement, srs)
        _add_styles(base, [layer for layer in layers if layer.style])
        base.commit()
    finally:
        base.close()


def _add(base: sqlite3.Connection, layer: Layer, placement: EarthPlacement, srs: int) -> None:
    columns = [(name, _type_of(layer, name)) for name in layer.attributes]
    typed = "".join(f', "{name}" {kind}' for name, kind in columns)
    base.execute(
        f'CREATE TABLE "{layer.name}" (fid INTEGER PRIMARY KEY AUTOINCREMENT, geom {layer.kind.upper()}{typed})'
    )
    placed = [_placed(feature, placement) for feature in layer.features]
    everything = np.concatenate([ring for rings in placed for ring in rings]) if placed else np.full((1, 2), np.nan)
    extent = [None] * 4 if not placed else [*everything.min(axis=0).tolist(), *everything.max(axis=0).tolist()]
    base.execute(
        "INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, ?)",
        (layer.name, layer.name, layer.title, _now(), *extent, srs),
    )
    base.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 0, 0)", (layer.name, layer.kind.upper(), srs)
    )
    names = "".join(f', "{name}"' for name, _ in columns)
    marks = ", ?" * len(columns)
    for feature, rings in zip(layer.features, placed, strict=True):
        base.execute(
            f'INSERT INTO "{layer.name}" (geom{names}) VALUES (?{marks})',
            (_blob(layer, rings, srs), *feature.values.values()),
        )


def _add_styles(base: sqlite3.Connection, layers: Sequence[Layer]) -> None:
    if not layers:
        return
    base.executescript(_STYLES)
    base.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, last_change) VALUES (?, 'attributes', ?, ?)",
        ("layer_styles", "layer_styles", _now()),
    )
    base.executemany(
        "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName,"
        " styleQML, useAsDefault, update_time) VALUES ('', '', ?, 'geom', ?, ?, 1, ?)",
        [(layer.name, layer.name, layer.style, _now()) for layer in layers],
    )


def _now() -> str:
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S.000Z")


def _type_of(layer: Layer, name: str) -> str:
    values = [feature.values[name] for feature in layer.features if feature.values[name] is not None]
    if values and all(isinstance(value, int) for value in values):
        return "INTEGER"
    return "TEXT" if values and isinstance(values[0], str) else "REAL"


def _placed(feature: Feature, placement: EarthPlacement) -> list[NDArray[np.float64]]:
    return [np.stack(placement.to_output(ring[:, 0], ring[:, 1]), axis=1) for ring in feature.rings]


def _blob(layer: Layer, rings: list[NDArray[np.float64]], srs: int) -> bytes:
    """Return a geometry as GeoPackage binary: a header without envelope, then well-known binary, little endian."""
    header: bytes = b"GP" + struct.pack("<BBi", 0, 1, srs)
    kind = struct.pack("<BI", 1, _WKB[layer.kind])
    if layer.kind == "Point":
        return header + kind + bytes(rings[0][0].astype("<f8").tobytes())
    if layer.kind == "LineString":
        return header + kind + _points(rings[0])
    parts = [struct.pack("<BII", 1, 3, 1) + _points(closed_ring(ring)) for ring in rings]
    return header + kind + struct.pack("<I", len(parts)) + b"".join(parts)


def _points(ring: NDArray[np.float64]) -> bytes:
    return struct.pack("<I", len(ring)) + bytes(ring.astype("<f8").tobytes())


def _reference_systems(placement: EarthPlacement) -> list[tuple[str, int, str, int, str, str]]:
    found = [
        ("Undefined cartesian SRS", -1, "NONE", -1, "undefined", "metres of the recording"),
        ("Undefined geographic SRS", 0, "NONE", 0, "undefined", "undefined geographic coordinates"),
    ]
    # The standard demands WGS 84 in every file; its text is short enough to stand here without pyproj.
    wgs84 = (
        'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],'
        'AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,'
        'AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]'
    )
    found.append(("WGS 84", 4326, "EPSG", 4326, wgs84, "longitude and latitude"))
    if placement.epsg is not None:
        from pyproj import CRS

        utm = CRS.from_epsg(placement.epsg)
        found.append((utm.name, placement.epsg, "EPSG", placement.epsg, utm.to_wkt("WKT1_GDAL"), "metres"))
    return found
