"""Caustics: light is bent, not lost; the film repeats and moves."""

import numpy as np
import pytest

from coral.reef.paint.caustics import FRAMES, SIZE, caustics


def test_light_is_only_moved():
    film = caustics(0, 5.0, 0.09)
    assert film.shape == (FRAMES, SIZE, SIZE)
    np.testing.assert_allclose(film.mean(axis=(1, 2)), 1.0, rtol=1e-5)
    assert film.min() >= 0.0


def test_waves_focus_more_on_a_deeper_floor():
    assert caustics(0, 1.0, 0.09).std() < 0.6 * caustics(0, 5.0, 0.09).std()


def test_a_flat_sea_lights_evenly():
    assert caustics(0, 5.0, 1e-9).std() == pytest.approx(0.0, abs=1e-4)


def test_the_film_moves_and_comes_back():
    film = caustics(0, 5.0, 0.09)
    step = np.abs(film[1] - film[0]).mean()
    assert step > 0.05
    assert np.abs(film[-1] - film[0]).mean() == pytest.approx(step, rel=0.3)
