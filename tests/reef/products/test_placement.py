"""A datum, and rasters placed by it."""

import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.products.placement import Datum, EarthPlacement, parse_datum, place_raster
from coral.reef.world.geometry import Pose

pytest.importorskip("pyproj")


def test_a_datum_is_two_or_three_numbers():
    assert parse_datum("36.95,-122.02") == Datum(36.95, -122.02)
    assert parse_datum("36.95, -122.02, 270") == Datum(36.95, -122.02, 270.0)


@pytest.mark.parametrize("text", ["36.95", "north,west", "89,0", "0,200", "1,2,3,4", "nan,0", "0,0,400"])
def test_another_text_is_refused(text):
    with pytest.raises(InputError, match="LAT,LON"):
        parse_datum(text)


def test_the_start_lies_at_the_datum_and_x_points_east():
    placement = EarthPlacement(Pose(2.0, 3.0, 1.0), Datum(36.95, -122.02))
    latitude, longitude = placement.to_degrees(np.array([2.0, 102.0, 2.0]), np.array([3.0, 3.0, 103.0]))
    assert (latitude[0], longitude[0]) == pytest.approx((36.95, -122.02), abs=1e-9)
    assert latitude[1] == pytest.approx(36.95, abs=1e-6)
    assert longitude[1] > -122.02
    # WGS 84 at 36.95 N: a second is 30.82 m along the meridian, 24.75 m along the parallel.
    assert (longitude[1] + 122.02) * 3600 == pytest.approx(100 / 24.75, rel=1e-3)
    assert (latitude[2] - 36.95) * 3600 == pytest.approx(100 / 30.82, rel=1e-3)


def test_with_a_heading_the_start_looks_there():
    placement = EarthPlacement(Pose(2.0, 3.0, 0.5), Datum(0.0, 9.0, heading=180.0))
    ahead = np.array([[2.0 + 10 * math.cos(0.5)], [3.0 + 10 * math.sin(0.5)]])
    latitude, longitude = placement.to_degrees(*ahead)
    assert latitude[0] < -8e-5
    assert longitude[0] == pytest.approx(9.0, abs=1e-9)


def test_there_and_back():
    placement = EarthPlacement(Pose(2.0, 3.0, 0.5), Datum(-33.8, 151.3, heading=30.0))
    x, y = np.array([0.0, 10.0, 25.0]), np.array([5.0, -3.0, 17.0])
    np.testing.assert_allclose(placement.from_output(*placement.to_output(x, y)), [x, y], atol=1e-6)
    assert placement.epsg == 32756


@pytest.mark.parametrize("heading", [None, 37.0])
def test_a_cell_of_a_placed_raster_is_where_the_cell_of_the_map_is(heading):
    values = np.zeros((40, 60), np.float32)
    values[30, 10] = 5.0
    placement = EarthPlacement(Pose(1.0, 1.0, 0.0), Datum(36.95, -122.02, heading))
    raster = place_raster(values, 0.5, placement, -1.0)
    easting, northing = (float(v[0]) for v in placement.to_output(np.array([5.25]), np.array([15.25])))
    row = int((raster.north - northing) / 0.5)
    column = int((easting - raster.west) / 0.5)
    assert raster.values[row, column] == 5.0
    assert np.count_nonzero(raster.values == 5.0) in (1, 2)


def test_without_a_datum_north_is_up_in_metres_of_the_map():
    values = np.arange(6, dtype=np.float32).reshape(2, 3)
    raster = place_raster(values, 0.5, EarthPlacement(Pose(0, 0, 0)), -1.0)
    np.testing.assert_array_equal(raster.values, values[::-1])
    assert (raster.west, raster.north, raster.pixel_m) == (0.0, 1.0, 0.5)
