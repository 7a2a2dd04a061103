"""GeoJSON, opened by GDAL."""

import json

import numpy as np
import pytest

from coral.reef.products.feature import Feature, Layer
from coral.reef.products.geojson import write_geojson
from coral.reef.products.placement import Datum, EarthPlacement
from coral.reef.world.geometry import Pose

pytest.importorskip("pyproj")


def test_gdal_finds_the_outline_where_it_lies(tmp_path):
    read_info = pytest.importorskip("pyogrio").read_info
    square = np.array([[2.0, 3.0], [12.0, 3.0], [12.0, 23.0], [2.0, 23.0]])
    layer = Layer("clusters", "MultiPolygon", (Feature((square,), {"number": 1, "area_m2": 0.5, "none": None}),))
    write_geojson(tmp_path / "x.geojson", layer, EarthPlacement(Pose(2.0, 3.0, 0.0), Datum(45.0, 9.0)))
    info = read_info(tmp_path / "x.geojson", force_total_bounds=True)
    assert info["crs"] == "EPSG:4326"
    assert info["features"] == 1
    # South-west corner at the start. WGS 84 at 45 N: 10 m are 0.457 s of longitude, 20 m 0.648 s of latitude.
    west, south, east, north = info["total_bounds"]
    assert (west, south) == pytest.approx((9.0, 45.0), abs=1e-8)
    assert ((east - 9.0) * 3600, (north - 45.0) * 3600) == pytest.approx((0.4566, 0.6479), abs=2e-4)


def test_points_and_lines_have_their_kinds(tmp_path):
    line = np.array([[0.0, 0.0], [1.0, 0.0]])
    for kind, count in (("Point", 2), ("LineString", 2)):
        layer = Layer("x", kind, (Feature((line,), {}),))
        write_geojson(tmp_path / "x.geojson", layer, EarthPlacement(Pose(0, 0, 0), Datum(45.0, 9.0)))
        geometry = json.loads((tmp_path / "x.geojson").read_text())["features"][0]["geometry"]
        assert geometry["type"] == kind
        assert len(geometry["coordinates"]) == count


@pytest.mark.parametrize(("longitude", "heading"), [(179.9999, 90.0), (-179.9999, 270.0)])
def test_what_lies_on_the_date_line_is_cut_there(tmp_path, longitude, heading):
    square = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [0.0, 10.0]])
    placement = EarthPlacement(Pose(0.0, 0.0, 0.0), Datum(-17.0, longitude, heading))
    layers = {kind: Layer("x", kind, (Feature((square,), {}),)) for kind in ("MultiPolygon", "LineString", "Point")}
    found = {}
    for kind, layer in layers.items():
        write_geojson(tmp_path / "x.geojson", layer, placement)
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
