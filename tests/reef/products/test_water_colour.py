"""Colours with the water's part taken back."""

import math

import numpy as np

from coral.reef.products.water_colour import MOST_GAIN, undo_attenuation
from coral.reef.world.water_types import find_water

WATER = find_water("jerlov-1C")


def test_what_the_water_took_comes_back():
    linear = 0.1
    gray = np.full((1, 1, 3), round(255 * (1.055 * linear ** (1 / 2.4) - 0.055)), np.uint8)
    made = undo_attenuation(gray, np.full((1, 1), 3.0, np.float32), WATER)[0, 0] / 255.0
    back = ((made + 0.055) / 1.055) ** 2.4
    expected = [linear * math.exp(g * 2.0) for g in WATER.lost]
    np.testing.assert_allclose(back, expected, rtol=0.03)


def test_water_itself_and_the_reference_distance_stay_as_they_are_and_gains_have_an_end():
    rgb = np.array([[[40, 90, 120], [40, 90, 120], [40, 40, 40]]], np.uint8)
    made = undo_attenuation(rgb, np.array([[1.0, np.inf, 50.0]], np.float32), WATER)
    np.testing.assert_array_equal(made[0, :2], rgb[0, :2])
    linear = ((40 / 255 + 0.055) / 1.055) ** 2.4
    most = 255 * (1.055 * (MOST_GAIN * linear) ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(made[0, 2], most, atol=1.0)
