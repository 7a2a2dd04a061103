"""The products as files: rasters, layers, tables, pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coral.drawing import png
from coral.file_writer import write_whole
from coral.reef.products import product_files
from coral.reef.products.map_files import (
    Feature,
    Layer,
    Value,
    write_geojson,
    write_geopackage,
    write_geotiff,
    write_table,
)
from coral.reef.products.placement import EarthPlacement, place_raster
from coral.reef.products.product_files import ProductFiles
from coral.reef.products.survey_products import DENSITY_CELL_M, SurveyProducts

NOTHING = -9999.0
CLUSTER_COLUMNS, SHELL_COLUMNS, DENSITY_COLUMNS = (
    tuple(" ".join(told).split()) for told in (product_files.CLUSTERS, product_files.SHELLS, product_files.DENSITY)
)


def write_products(products: SurveyProducts, placement: EarthPlacement, folder: Path, lens: str = "") -> list[str]:
    """Write all files into a new or empty folder, and return their names.

    `lens` says how the lens disagrees with the pictures.

    Raises:
        InputError: A package of the extra geo is missing.
        OSError: A file cannot be written.
    """
    _write_rasters(products, placement, folder)
    write_whole(folder / ProductFiles.CELLS, png(products.cells.cells()))
    layers = make_layers(products, placement)
    write_geopackage(folder / ProductFiles.SURVEY, layers, placement)
    if placement.datum is not None:
        write_geojson(folder / ProductFiles.PLACES, layers[0], placement)
    write_table(folder / ProductFiles.CLUSTERS, CLUSTER_COLUMNS, [feature.values for feature in layers[0].features])
    write_table(folder / ProductFiles.DENSITIES, DENSITY_COLUMNS, [feature.values for feature in layers[1].features])
    write_table(folder / ProductFiles.SHELLS, SHELL_COLUMNS, _shells(products))
    for name, picture in zip(picture_names(products), products.pictures, strict=True):
        write_whole(folder / name, png(picture.image))
    write_whole(
        folder / ProductFiles.NUMBERS, (json.dumps(summary(products, placement, lens), indent=2) + "\n").encode()
    )
    return sorted({str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()})


def summary(products: SurveyProducts, placement: EarthPlacement, lens: str = "") -> dict[str, Any]:
    """Return the main numbers."""
    datum = placement.datum
    return {
        "recording": products.recording.name,
        "lens": lens,
        "keyframes": products.keyframes,
        "oyster_area_m2": round(products.area.value, 3) if products.judgement.judged else None,
        "oyster_area_low_m2": round(products.area.low, 3),
        "oyster_area_high_m2": round(products.area.high, 3),
        "not_judged": products.judgement.warning(),
        "pictures_unlike": products.judgement.unlike,
        "seen_m2": round(products.seen_m2, 1),
        **_count_of(products),
        "oyster_cells": int(products.cells.target.sum()),
        "clusters": len(products.clusters),
        "colour": products.mosaic.colour,
        "perception": products.recording.seen_by,
        "calibrated_reefs": products.calibrated_reefs,
        "latitude": None if datum is None else datum.latitude,
        "longitude": None if datum is None else datum.longitude,
        "epsg": placement.epsg,
    }


def _count_of(products: SurveyProducts) -> dict[str, Any]:
    """Return number, density and length of the oysters, each with its interval; None where nobody can tell."""
    shells, seen = products.shells, max(products.seen_m2, 1e-9)
    density = None if shells.oysters is None else shells.oysters.times(1.0 / seen)
    millimetres = None if shells.length is None else shells.length.times(1000.0)
    told: dict[str, Any] = {}
    for name, found, digits in (
        ("outlines", shells.outlines, 0),
        ("oysters", shells.oysters, 0), ("oysters_per_m2", density, 2), ("shell_length_mm", millimetres, 0),
    ):  # fmt: skip
        for end, key in (("value", name), ("low", f"{name}_low"), ("high", f"{name}_high")):
            told[key] = None if found is None else round(getattr(found, end), digits)
    return told


def picture_names(products: SurveyProducts) -> list[str]:
    """Return the file name of each of the best pictures."""
    seen: dict[int, int] = {}
    names = []
    for picture in products.pictures:
        seen[picture.cluster] = seen.get(picture.cluster, 0) + 1
        names.append(f"{ProductFiles.PICTURES}cluster-{picture.cluster:02d}-{seen[picture.cluster]}.png")
    return names


def make_layers(products: SurveyProducts, placement: EarthPlacement) -> list[Layer]:
    """Return the layers: clusters, density, pictures, track."""
    names: dict[int, list[str]] = {}
    for name, picture in zip(picture_names(products), products.pictures, strict=True):
        names.setdefault(picture.cluster, []).append(name)
    clusters = []
    for one in products.clusters:
        latitude, longitude = _degrees(one.x, one.y, placement)
        values: Mapping[str, Value] = {
            "number": one.number, "x_m": round(one.x, 3), "y_m": round(one.y, 3),
            "latitude": latitude, "longitude": longitude,
            "area_m2": round(one.area.value, 4), "area_low_m2": round(one.area.low, 4),
            "area_high_m2": round(one.area.high, 4), "outline_m2": round(one.outline_m2, 4),
            "cover": round(one.cover, 4), "seen_from_m": _finite(one.seen_from_m),
            "pixel_mm": _finite(1000.0 * one.pixel_m), "looks": one.looks,
            "pictures": " ".join(names.get(one.number, ())),
        }  # fmt: skip
        clusters.append(Feature(one.outlines, dict(values)))
    points = [
        Feature(
            (np.array([[picture.x, picture.y]]),),
            {"picture": name, "cluster": picture.cluster, "t_s": round(picture.t, 2), "pixels": picture.pixels},
        )
        for name, picture in zip(picture_names(products), products.pictures, strict=True)
    ]
    track = [Feature((products.track,), {"pictures": products.keyframes})] if products.keyframes > 1 else []
    return [
        Layer("clusters", "oyster clusters", "MultiPolygon", tuple(clusters), CLUSTER_COLUMNS),
        Layer("density", "oysters per sea floor", "MultiPolygon", tuple(_density(products)), DENSITY_COLUMNS),
        Layer("pictures", "the best pictures", "Point", tuple(points), ("picture", "cluster", "t_s", "pixels")),
        Layer("track", "where pictures were taken", "LineString", tuple(track), ("pictures",)),
    ]


def _shells(products: SurveyProducts) -> list[dict[str, Value]]:
    """Return a row for each shell that lies apart."""
    of = products.shells.singles
    table = np.column_stack([of.x, of.y, 1e3 * of.length, 1e3 * of.width, 1e4 * of.area])
    return [dict(zip(SHELL_COLUMNS, np.round(row, 3).tolist(), strict=True)) for row in table]


def _write_rasters(products: SurveyProducts, placement: EarthPlacement, folder: Path) -> None:
    cell_m, focal = products.cells.cfg.cell_m, products.cells.focal_px
    mosaic = place_raster(products.mosaic.rgba, products.mosaic.pixel_m, placement, 0)
    write_geotiff(folder / ProductFiles.MOSAIC, mosaic, placement.epsg)
    layers = (
        (
            ProductFiles.OYSTERS, products.cover[:, :, None], cell_m,
            ("share of the cell that oysters cover",),
        ),
        (
            ProductFiles.DENSITY, products.density[:, :, None], DENSITY_CELL_M,
            ("oysters per sea floor seen (m2/m2)",),
        ),
        (
            ProductFiles.SEEN,
            np.dstack([products.cells.nearest, products.cells.nearest / np.float32(focal), products.looks]),
            cell_m,
            ("nearest look (m)", "size of a pixel at the nearest look (m)", "pictures that show the cell"),
        ),
    )  # fmt: skip
    for name, values, edge_m, bands in layers:
        filled = np.where(np.isfinite(values), values, NOTHING).astype(np.float32)
        if name == ProductFiles.SEEN:
            filled[products.looks == 0] = NOTHING
        raster = place_raster(filled, edge_m, placement, NOTHING)
        write_geotiff(folder / name, raster, placement.epsg, bands=bands, nothing=NOTHING)


def _density(products: SurveyProducts) -> list[Feature]:
    edge = DENSITY_CELL_M
    features = []
    for iy, ix in zip(*np.nonzero(np.nan_to_num(products.density) > 0.0), strict=True):
        x, y = ix * edge, iy * edge
        square = np.array([[x, y], [x + edge, y], [x + edge, y + edge], [x, y + edge]])
        share = round(float(products.density[iy, ix]), 4)
        values: dict[str, Value] = {
            "x_m": round(x + edge / 2, 3), "y_m": round(y + edge / 2, 3), "oysters_m2_per_m2": share,
        }  # fmt: skip
        features.append(Feature((square,), values))
    return features


def _degrees(x: float, y: float, placement: EarthPlacement) -> tuple[float | None, float | None]:
    if placement.datum is None:
        return None, None
    latitude, longitude = placement.to_degrees(x, y)
    return round(float(latitude), 8), round(float(longitude), 8)


def _finite(value: float) -> float | None:
    return round(value, 3) if np.isfinite(value) else None
