"""All that is measured of a recording."""

import numpy as np
import pytest

from coral.reef.products.survey_products import mean_in_cells


def test_area_density_and_clusters_agree(products):
    known = np.isfinite(products.density)
    spread = np.nansum(products.density) * products.density_cell_m**2
    assert spread == pytest.approx(products.area.m2, rel=0.05)
    assert known.any()
    assert not known.all()
    assert sum(one.area.m2 for one in products.clusters) == pytest.approx(products.area.m2, rel=0.2)
    assert products.track.shape == (products.keyframes, 2) == (41, 2)


def test_the_mean_is_of_what_is_known():
    share = np.array([[1.0, 0.0, 0.5, 0.5]], np.float32)
    known = np.array([[True, True, True, False]])
    np.testing.assert_allclose(mean_in_cells(share, known, 0.5, 1.0, (1, 2), 0.2), [[0.5, 0.5]])
    assert np.isnan(mean_in_cells(share, known & False, 0.5, 1.0, (1, 2), 0.2)).all()
