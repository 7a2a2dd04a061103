"""Exposure: the same brightness in any light, noise that grows with darkness, a known curve."""

import numpy as np
import pytest

from coral.reef.paint.exposure import expose, noise_seed, srgb_table
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.world.geometry import Pose

QUIET = PainterCfg(photons=1e12, read_noise=0.0, vignette=0.0)


def scene(level=1.0, tint=(1.0, 1.0, 1.0)):
    ramp = np.linspace(0.05, 1.0, 40, dtype=np.float32)
    return np.ascontiguousarray((level * ramp)[None, :, None] * np.float32(tint) * np.ones((30, 1, 1), np.float32))


def test_the_curve_is_srgb():
    table = srgb_table()
    assert table[0] == 0
    assert table[-1] == 255
    assert table[round(0.18 * 4095)] == pytest.approx(118, abs=1)  # middle gray, IEC 61966-2-1


def test_pictures_are_as_bright_in_the_dark_as_in_the_light():
    assert np.array_equal(expose(scene(1.0), QUIET, 0), expose(scene(0.125), QUIET, 0))


def test_exposure_aims_at_its_mean():
    picture = expose(np.full((30, 40, 3), 3.7, np.float32), QUIET, 0)
    assert np.unique(picture).tolist() == [int(srgb_table()[round(0.2 * 4095)])]


def test_white_balance_goes_part_of_the_way_to_gray():
    tint = (0.25, 1.0, 0.5)

    def red_share(balance):
        picture = expose(scene(tint=tint), PainterCfg(photons=1e12, read_noise=0.0, white_balance=balance), 0)
        return picture[..., 0].mean() / picture[..., 1].mean()

    assert red_share(0.0) < red_share(0.5) < red_share(1.0)
    assert red_share(1.0) == pytest.approx(1.0, abs=0.02)


def test_noise_is_stronger_in_the_dark():
    cfg = PainterCfg(vignette=0.0)
    dark, bright = (expose(np.full((60, 80, 3), level, np.float32), cfg, 1).std() for level in (1e-3, 1.0))
    assert dark > 3.0 * bright


def test_noise_is_normal_and_its_seed_decides():
    cfg = PainterCfg(vignette=0.0, photons=1e12, read_noise=0.02)
    even = np.full((120, 160, 3), 1.0, np.float32)
    picture = expose(even, cfg, 1)
    assert np.array_equal(picture, expose(even, cfg, 1))
    assert not np.array_equal(picture, expose(even, cfg, 2))
    # sRGB at 0.2 has the slope 1.055 / 2.4 * 0.2^(1 / 2.4 - 1) = 1.124.
    assert picture.std() == pytest.approx(0.02 * 255 * 1.124, rel=0.05)


def test_every_pose_and_time_has_its_own_noise():
    seeds = {noise_seed(1, Pose(1.0, y, 0.0), t) for y in (0.0, 0.1) for t in (0.0, 0.1)}
    assert len(seeds) == 4


def test_corners_are_darker():
    cfg = PainterCfg(photons=1e12, read_noise=0.0, vignette=0.5)
    picture = expose(np.full((30, 40, 3), 1.0, np.float32), cfg, 0)
    assert picture[0, 0, 0] < picture[15, 20, 0]
