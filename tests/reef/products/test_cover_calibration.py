"""What a network's votes for oysters mean."""

import math

import numpy as np
import pytest

from coral.reef.products.cover_calibration import BINS, CoverCalibration, bins_of, find_calibration

CALIBRATION = CoverCalibration(tuple(k / BINS for k in range(BINS)), 0.03, 0.1, 4, "by hand")


def test_cells_fall_into_bins_by_share_and_distance():
    shares, depths = np.array([0.0, 0.005, 1.0, 1.0], np.float32), np.array([0.5, 0.9, 0.5, np.inf], np.float32)
    np.testing.assert_array_equal(bins_of(shares, depths), [0, 1, BINS - 8, BINS - 1])
    np.testing.assert_allclose(
        CALIBRATION.apply(shares, depths), np.array([0, 1, BINS - 8, BINS - 1]) / BINS, rtol=1e-6
    )


def test_an_area_errs_by_what_its_reef_shares_and_by_its_parts():
    assert CALIBRATION.std_m2(4.0) == pytest.approx(math.sqrt(1.25 * ((0.03 * 4.0) ** 2 + 0.1**2 * 4.0)))
    assert CALIBRATION.std_m2(0.0) == 0.0


def test_the_shipped_network_is_calibrated():
    cover = np.array(find_calibration("painted").cover).reshape(-1, 8)
    assert cover.shape == (15, 8)
    # It takes too much for oysters: even where all votes are for them, shells cover less.
    assert 0.3 < cover[-1, 0] < 0.95
    assert cover[0].max() < 0.05
    assert find_calibration("other.onnx") is None
