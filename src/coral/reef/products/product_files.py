"""The files of a survey's products, with the columns of their tables: the reference prints them."""

from __future__ import annotations

from typing import Final


class ProductFiles:
    """Files of a folder of products."""

    PAGE: Final = "products.html"
    """The page for people."""
    MOSAIC: Final = "orthomosaic.tif"
    """The sea floor from above, pixels of 2 cm (`--cfg.mosaic.pixel-m`), red, green, blue and alpha. Without colour
    pictures it shows class colours, and the page says so."""
    OYSTERS: Final = "oysters.tif"
    """Share of each cell of 5 cm that oysters cover, 0 to 1."""
    DENSITY: Final = "density.tif"
    """Share of the sea floor seen that oysters cover, in cells of 0.5 m."""
    SEEN: Final = "seen.tif"
    """How well each part was seen: distance of the nearest look (m), size of a pixel there (m), number of pictures."""
    CLUSTERS: Final = "clusters.csv"
    """One row per cluster."""
    PLACES: Final = "clusters.geojson"
    """The clusters with their outlines, in longitude and latitude; only with `--datum`."""
    DENSITIES: Final = "density.csv"
    """One row per cell with oysters."""
    SHELLS: Final = "shells.csv"
    """One row per shell that lies apart."""
    SURVEY: Final = "survey.gpkg"
    """GeoPackage with clusters, density, places of the pictures, track."""
    CELLS: Final = "cells.png"
    """The map's cells: 0 unexplored, 1 free, 2 obstacle, 3 oysters."""
    PICTURES: Final = "pictures/"
    """Up to three pictures of each cluster."""
    LABELS: Final = "labels/"
    """Pictures evenly spread over the survey, as JPEG, and what was seen in them, for people to correct."""
    COCO: Final = "labels/coco.json"
    """Outlines of patches of oysters."""
    CORALNET: Final = "labels/coralnet.csv"
    """Points for CoralNet: `Name`, `Row`, `Column`, `Label`."""
    POINTS: Final = "labels/points.csv"
    """The same with `Doubt` and the place, `x_m` and `y_m`."""
    NUMBERS: Final = "products.json"
    """The main numbers."""


CLUSTERS = {
    "number": "As on the page and in the names of pictures.",
    "x_m y_m latitude longitude": "Its middle.",
    "area_m2 area_low_m2 area_high_m2": "Area of oysters, with its interval.",
    "outline_m2": "Area within its outline.",
    "cover": "Share of `outline_m2` that oysters cover.",
    "seen_from_m pixel_mm looks": "Nearest look, size of a pixel there, number of pictures.",
    "pictures": "Its best pictures.",
}
"""Columns of clusters.csv."""
SHELLS = {
    "x_m y_m": "Its middle.",
    "length_mm width_mm": "Its longest extent, and that across.",
    "area_cm2": "Its area, seen from above.",
}
"""Columns of shells.csv."""
DENSITY = {"x_m y_m": "Middle of the cell.", "oysters_m2_per_m2": "Share of its sea floor seen that oysters cover."}
"""Columns of density.csv."""
