"""Where the sun stands under water."""

import math

import pytest

from coral.reef.simulation.daylight import PainterCfg, sun_direction


def test_light_is_bent_towards_the_vertical():
    x, y, z = sun_direction(PainterCfg(sun_elevation_deg=30.0, sun_azimuth_deg=0.0))
    assert y == pytest.approx(0.0, abs=1e-12)
    # Snell: sin(60°) / 1.34.
    assert x == pytest.approx(math.sin(math.radians(60.0)) / 1.34)
    assert math.hypot(x, z) == pytest.approx(1.0)


def test_a_sun_overhead_stays_overhead():
    assert sun_direction(PainterCfg(sun_elevation_deg=90.0))[2] == pytest.approx(1.0)
