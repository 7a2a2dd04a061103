"""Range images: where their beams point."""

import math

import numpy as np
import pytest

from coral.reef.vehicle.range_image import RangeImage, beam_angles


def test_beams_point_as_in_the_makers_integration_page():
    """There x is forward, y right and z down; yaw = px / (w - 1) fov - fov / 2, pitch likewise, z = -r sin(pitch)."""
    image = RangeImage(np.full((5, 9), 3.0, np.float32), 90.0, 40.0)
    beams = image.directions()
    for py, px in ((0, 0), (4, 8), (1, 6), (2, 4)):
        yaw, pitch = math.radians(px / 8 * 90.0 - 45.0), math.radians(py / 4 * 40.0 - 20.0)
        forward, right, down = math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), -math.sin(pitch)
        assert beams[py, px] == pytest.approx([forward, -right, -down])


def test_the_first_column_is_the_leftmost_and_the_first_row_the_lowest():
    azimuth, elevation = beam_angles((3, 5), 90.0, 40.0)
    assert np.degrees(azimuth) == pytest.approx([45.0, 22.5, 0.0, -22.5, -45.0])
    assert np.degrees(elevation) == pytest.approx([-20.0, 0.0, 20.0])
