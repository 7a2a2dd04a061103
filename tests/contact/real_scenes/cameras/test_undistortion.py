import numpy as np
import pytest

from coral.contact.real_scenes.cameras.undistortion import Undistortion

LENS = np.array([60.0, 60.0, 31.5, 23.5])
BARREL = np.array([-0.2, 0.05, 0.001, 0.0, 0.0])


def distorted(x, y, d):
    """Brown and Conrady's model, as its authors wrote it."""
    r = x * x + y * y
    radial = 1 + d[0] * r + d[1] * r * r + d[4] * r**3
    return (
        x * radial + 2 * d[2] * x * y + d[3] * (r + 2 * x * x),
        y * radial + d[2] * (r + 2 * y * y) + 2 * d[3] * x * y,
    )


@pytest.mark.parametrize("inverse", [False, True])
def test_a_pixel_is_looked_up_where_the_lens_put_it(inverse):
    u, v = np.meshgrid(np.arange(64.0), np.arange(48.0))
    removal = Undistortion(LENS, BARREL, (48, 64), inverse=inverse)
    columns, rows = removal.apply(u.astype(np.float32)), removal.apply(v.astype(np.float32))
    straight = ((50 - 31.5) / 60, (40 - 23.5) / 60)
    seen = ((columns[40, 50] - 31.5) / 60, (rows[40, 50] - 23.5) / 60)
    there, expected = (distorted(*seen, BARREL), straight) if inverse else (seen, distorted(*straight, BARREL))
    assert there == pytest.approx(expected, abs=0.75 / 60)  # half a pixel in both directions
    assert seen != pytest.approx(straight, abs=0.75 / 60)


def test_a_lens_without_distortion_changes_nothing():
    picture = np.random.default_rng(0).random((48, 64)).astype(np.float32)
    assert np.array_equal(Undistortion(LENS, np.zeros(5), (48, 64)).apply(picture), picture)
