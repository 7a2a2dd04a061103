"""Local metres, degrees, UTM."""

import numpy as np
import pytest

from coral.reef.recordings.local_plane import LocalPlane

pytest.importorskip("pyproj")


def test_a_degree_of_latitude_and_of_longitude_has_its_length():
    # WGS 84 at 45 N: a second of arc is 30.870 m along the meridian, 21.902 m along the parallel.
    x, y = LocalPlane(45.0, 9.0).from_degrees(45.0 + 1 / 3600, 9.0 + 1 / 3600)
    assert (x, y) == pytest.approx((21.902, 30.870), abs=0.005)


def test_there_and_back():
    plane = LocalPlane(-36.8, 174.9)
    assert plane.epsg == 32760
    x, y = np.array([0.0, 120.0, -40.0]), np.array([0.0, 7.0, 90.0])
    np.testing.assert_allclose(plane.from_utm(*plane.to_utm(x, y)), [x, y], atol=1e-6)
    latitude, longitude = plane.to_degrees(x, y)
    assert plane.from_degrees(latitude[1], longitude[1]) == pytest.approx((120.0, 7.0), abs=1e-6)


def test_utm_of_a_known_place():
    # The middle of zone 32 at the equator: 500 km east by definition.
    easting, northing = LocalPlane(0.0, 9.0).to_utm(np.array([0.0]), np.array([0.0]))
    assert (easting[0], northing[0]) == pytest.approx((500_000.0, 0.0), abs=1e-4)
