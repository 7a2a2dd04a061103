"""GeoPackage, opened by GDAL."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.products.feature import Feature, Layer
from coral.reef.products.geopackage import write_geopackage
from coral.reef.products.placement import Datum, EarthPlacement
from coral.reef.products.qgis_styles import outline_style
from coral.reef.world.geometry import Pose

pytest.importorskip("pyproj")
pyogrio = pytest.importorskip("pyogrio")

SQUARE = np.array([[2.0, 3.0], [12.0, 3.0], [12.0, 23.0], [2.0, 23.0]])
LAYERS = [
    Layer("clusters", "MultiPolygon", (Feature((SQUARE, SQUARE + 30.0), {"number": 1, "area": 0.5, "note": "a"}),)),
    Layer("track", "LineString", (Feature((SQUARE,), {"pictures": 4}),)),
    Layer("pictures", "Point", (), columns=("picture",)),
]


def test_gdal_reads_layers_values_and_places(tmp_path):
    placement = EarthPlacement(Pose(2.0, 3.0, 0.0), Datum(0.0, 9.0))
    write_geopackage(tmp_path / "x.gpkg", LAYERS, placement)
    assert [tuple(one) for one in pyogrio.list_layers(tmp_path / "x.gpkg")] == [
        ("clusters", "MultiPolygon"), ("track", "LineString"), ("pictures", "Point"),
    ]  # fmt: skip
    info = pyogrio.read_info(tmp_path / "x.gpkg", layer="clusters", force_total_bounds=True)
    assert info["crs"] == "EPSG:32632"
    assert list(info["fields"]) == ["number", "area", "note"]
    # The middle of zone 32 at the equator, with UTM's scale of 0.9996.
    assert info["total_bounds"][:2] == pytest.approx((500_000.0, 0.0), abs=1e-3)
    assert info["total_bounds"][2:] == pytest.approx((500_000.0 + 40 * 0.9996, 50 * 0.9996), abs=1e-2)
    _, _, _, values = pyogrio.raw.read(tmp_path / "x.gpkg", layer="clusters", read_geometry=False)
    assert [column[0] for column in values] == [1, 0.5, "a"]


def test_without_a_datum_there_is_no_place(tmp_path):
    write_geopackage(tmp_path / "x.gpkg", LAYERS, EarthPlacement(Pose(2.0, 3.0, 0.0)))
    info = pyogrio.read_info(tmp_path / "x.gpkg", layer="track", force_total_bounds=True)
    assert tuple(info["total_bounds"]) == (2.0, 3.0, 12.0, 23.0)


def test_gdal_reads_the_style_that_qgis_draws_a_layer_with(tmp_path):
    styled = replace(LAYERS[0], style=outline_style("number"))
    write_geopackage(tmp_path / "x.gpkg", [styled, *LAYERS[1:]], EarthPlacement(Pose(2.0, 3.0, 0.0)))
    meta, _, _, values = pyogrio.raw.read(tmp_path / "x.gpkg", layer="layer_styles", read_geometry=False)
    row = dict(zip(meta["fields"], (column[0] for column in values), strict=True))
    assert len(values[0]) == 1
    assert (row["f_table_name"], row["f_geometry_column"], bool(row["useAsDefault"])) == ("clusters", "geom", True)
    assert ET.fromstring(row["styleQML"].split("\n", 1)[1]).find("renderer-v2").get("type") == "singleSymbol"
