"""All that is measured of a recording."""

from dataclasses import replace

import numpy as np
import pytest

from coral.reef.products.cover import BINS, CoverCalibration
from coral.reef.products.survey_products import DENSITY_CELL_M, ProductsCfg, mean_in_cells, measure


def test_area_density_and_clusters_agree(products):
    known = np.isfinite(products.density)
    spread = np.nansum(products.density) * DENSITY_CELL_M**2
    assert spread == pytest.approx(products.area.value, rel=0.05)
    assert known.any()
    assert not known.all()
    assert sum(one.area.value for one in products.clusters) == pytest.approx(products.area.value, rel=0.2)
    assert products.track.shape == (products.keyframes, 2) == (41, 2)


def test_the_mean_is_of_what_is_known(monkeypatch):
    for place in ("survey_products", "cover"):
        monkeypatch.setattr(f"coral.reef.products.{place}.FINE_M", 0.5)
    share = np.array([[1.0, 0.0, 0.5, 0.5]], np.float32)
    known = np.array([[True, True, True, False]])
    np.testing.assert_allclose(mean_in_cells(share, known, 1.0, (1, 2)), [[0.5, 0.5]])
    assert np.isnan(mean_in_cells(share, known & False, 1.0, (1, 2))).all()


def test_cells_that_a_calibrated_network_hardly_covers_are_no_oysters(recording, monkeypatch):
    def doubtful():
        for one in recording.keyframes():
            yield replace(one, frame=replace(one.frame, doubt=np.full(one.frame.depth.shape, 0.1, np.float32)))

    seen = replace(recording, keyframes=doubtful, seen_by="net")
    found = {}
    for name, cover in (("sure", 0.5), ("doubtful", 0.1)):
        calibration = CoverCalibration((cover,) * BINS, 0.0, 0.0, 5, "")
        monkeypatch.setattr("coral.reef.products.cover.find_calibration", lambda perception, it=calibration: it)
        found[name] = measure(seen, ProductsCfg())
    assert found["sure"].cells.target.sum() > 200
    assert (len(found["sure"].clusters), found["sure"].calibrated_reefs) == (1, 5)
    assert not found["doubtful"].cells.target.any()
    assert found["doubtful"].clusters == ()
    # The area is that of all votes all the same: doubtful cells have oysters now and then.
    assert found["doubtful"].area.value == pytest.approx(0.2 * found["sure"].area.value)
