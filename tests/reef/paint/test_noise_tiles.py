"""Noise tiles: seamless, with coarser levels that are means of the finer ones."""

import numpy as np

from coral.reef.paint.noise_tiles import FLAKES, GRAIN, PEBBLES, SIZE, SMOOTH, noise_tile


def level(k):
    n = SIZE >> k
    start = (4 * SIZE**2 - 4 * n**2) // 3
    return noise_tile(0)[start : start + n * n].reshape(n, n, 4) / 255.0


def test_all_levels_are_there_down_to_one_texel():
    assert noise_tile(0).shape == ((4 * SIZE**2 - 1) // 3, 4)
    np.testing.assert_allclose(level(9)[0, 0], level(0).mean(axis=(0, 1)), atol=4e-3)


def test_a_texel_is_the_mean_of_the_four_below():
    fine = level(0)
    np.testing.assert_allclose(level(1)[3, 5], fine[6:8, 10:12].mean(axis=(0, 1)), atol=4e-3)


def test_there_is_no_seam():
    """Across the edge neighbours differ as much as anywhere else."""
    fine = level(0)
    inside = np.abs(np.diff(fine, axis=0)).mean(axis=(0, 1))
    across = np.abs(fine[0] - fine[-1]).mean(axis=0)
    assert (across < 1.5 * inside).all()


def test_clouds_are_smoother_than_grain():
    fine = level(0)
    change = np.abs(np.diff(fine, axis=1)).mean(axis=(0, 1)) / fine.std(axis=(0, 1))
    assert change[SMOOTH] < 0.5 * change[GRAIN]


def test_most_of_a_tile_lies_between_its_bits():
    fine = level(0)
    for channel in (FLAKES, PEBBLES):
        assert 0.2 < (fine[..., channel] == 0.0).mean() < 0.9
