"""Maps as files, opened by GDAL."""

import json

import numpy as np
import pytest

from coral.reef.products.map_files import (
    Feature,
    Layer,
    closed_ring,
    write_geojson,
    write_geopackage,
    write_geotiff,
    write_table,
)
from coral.reef.products.placement import Datum, EarthPlacement, PlacedRaster
from coral.reef.world.geometry import Pose

pytest.importorskip("pyproj")
pyogrio = pytest.importorskip("pyogrio")
pytest.importorskip("tifffile")
rasterio = pytest.importorskip("rasterio")

SQUARE = np.array([[2.0, 3.0], [12.0, 3.0], [12.0, 23.0], [2.0, 23.0]])


def layer(name, kind, feature):
    return Layer(name, f"some {name}", kind, (feature,), tuple(feature.values))


LAYERS = [
    layer("clusters", "MultiPolygon", Feature((SQUARE, SQUARE + 30.0), {"number": 1, "area": 0.5, "note": "a"})),
    layer("track", "LineString", Feature((SQUARE,), {"pictures": 4})),
    Layer("pictures", "", "Point", (), ("picture",)),
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


def test_gdal_finds_the_outline_where_it_lies(tmp_path):
    square = np.array([[2.0, 3.0], [12.0, 3.0], [12.0, 23.0], [2.0, 23.0]])
    clusters = layer("clusters", "MultiPolygon", Feature((square,), {"number": 1, "area_m2": 0.5, "none": None}))
    write_geojson(tmp_path / "x.geojson", clusters, EarthPlacement(Pose(2.0, 3.0, 0.0), Datum(45.0, 9.0)))
    info = pyogrio.read_info(tmp_path / "x.geojson", force_total_bounds=True)
    assert info["crs"] == "EPSG:4326"
    assert info["features"] == 1
    # South-west corner at the start. WGS 84 at 45 N: 10 m are 0.457 s of longitude, 20 m 0.648 s of latitude.
    west, south, east, north = info["total_bounds"]
    assert (west, south) == pytest.approx((9.0, 45.0), abs=1e-8)
    assert ((east - 9.0) * 3600, (north - 45.0) * 3600) == pytest.approx((0.4566, 0.6479), abs=2e-4)


def test_points_and_lines_have_their_kinds(tmp_path):
    line = np.array([[0.0, 0.0], [1.0, 0.0]])
    for kind, count in (("Point", 2), ("LineString", 2)):
        of_kind = layer("x", kind, Feature((line,), {}))
        write_geojson(tmp_path / "x.geojson", of_kind, EarthPlacement(Pose(0, 0, 0), Datum(45.0, 9.0)))
        geometry = json.loads((tmp_path / "x.geojson").read_text())["features"][0]["geometry"]
        assert geometry["type"] == kind
        assert len(geometry["coordinates"]) == count


@pytest.mark.parametrize(("longitude", "heading"), [(179.9999, 90.0), (-179.9999, 270.0)])
def test_what_lies_on_the_date_line_is_cut_there(tmp_path, longitude, heading):
    square = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [0.0, 10.0]])
    placement = EarthPlacement(Pose(0.0, 0.0, 0.0), Datum(-17.0, longitude, heading))
    found = {}
    for kind in ("MultiPolygon", "LineString", "Point"):
        write_geojson(tmp_path / "x.geojson", layer("x", kind, Feature((square,), {})), placement)
        found[kind] = json.loads((tmp_path / "x.geojson").read_text())["features"][0]["geometry"]
    assert found["LineString"]["type"] == "MultiLineString"
    parts = [ring for (ring,) in found["MultiPolygon"]["coordinates"]] + found["LineString"]["coordinates"]
    assert len(found["MultiPolygon"]["coordinates"]) == 2
    for part in parts:
        degrees = np.array(part)
        assert np.abs(degrees[:, 0]).max() <= 180.0
        assert np.ptp(degrees[:, 0]) < 0.001
    for ring in parts[:2]:
        assert ring[0] == ring[-1]
    width = sum(np.ptp(np.array(ring)[:, 0]) for ring in parts[:2])
    assert width * 111_320.0 * np.cos(np.radians(17.0)) == pytest.approx(40.0, abs=0.2)
    assert found["Point"]["coordinates"][0] == pytest.approx(longitude)


def test_a_ring_is_closed_and_counter_clockwise():
    clockwise = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])
    ring = closed_ring(clockwise)
    np.testing.assert_array_equal(ring[0], ring[-1])
    assert len(ring) == 5
    assert ring[1].tolist() == [1.0, 0.0]
    np.testing.assert_array_equal(closed_ring(ring), ring)


def test_rows_come_in_the_order_of_the_columns_and_what_is_not_known_is_empty(tmp_path):
    write_table(tmp_path / "t.csv", ("a", "b"), [{"b": 1.5, "a": "x, y"}, {"a": 2, "b": None}])
    assert (tmp_path / "t.csv").read_text() == 'a,b\n"x, y",1.5\n2,\n'


def test_gdal_reads_values_place_names_and_what_is_nothing(tmp_path):
    values = np.arange(24, dtype=np.float32).reshape(3, 4, 2)
    raster = PlacedRaster(values, 500_000.0, 4_000_000.0, 0.5)
    write_geotiff(tmp_path / "x.tif", raster, 32610, bands=("a < b", "c"), nothing=-9999.0)
    with rasterio.open(tmp_path / "x.tif") as opened:
        assert opened.crs.to_epsg() == 32610
        assert opened.nodata == -9999.0
        assert opened.descriptions == ("a < b", "c")
        assert opened.xy(0, 0) == (500_000.25, 3_999_999.75)
        np.testing.assert_array_equal(np.moveaxis(opened.read(), 0, 2), values)


def test_colours_have_alpha(tmp_path):
    values = np.zeros((5, 6, 4), np.uint8)
    values[..., 3] = 255
    write_geotiff(tmp_path / "x.tif", PlacedRaster(values, 0.0, 2.5, 0.5), None)
    with rasterio.open(tmp_path / "x.tif") as opened:
        names = [one.name for one in opened.colorinterp]
        assert names == ["red", "green", "blue", "alpha"]
        assert opened.crs is None or opened.crs.to_epsg() is None
        assert opened.bounds == (0.0, 0.0, 3.0, 2.5)
