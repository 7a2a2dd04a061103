"""A network's oysters against the truth."""

import math
from dataclasses import replace

import numpy as np
import pytest
from survey_runs import patch

from coral.errors import InputError
from coral.reef.products.calibrate_cover import AreaEvidence, ReefEvidence, calibrate, fit_cover, gather_evidence
from coral.reef.products.cover import CoverCfg
from coral.reef.products.cover_calibration import BINS
from coral.reef.products.truth import true_area_m2


def reef(true_m2, *clusters):
    """One bin holds 20 m² of votes, a tenth of them shells, whatever the truth is."""
    cells = np.zeros(BINS)
    cells[7] = 20.0
    parts = tuple(AreaEvidence(one, cells * one / 2.0) for one in clusters)
    return ReefEvidence("x", AreaEvidence(true_m2, cells), parts, cells * 100.0, cells * 10.0)


def test_areas_are_right_on_the_whole():
    # A tenth of the votes' cells are shells, but the survey misses 5 % of them: the scale makes up for it.
    cover = fit_cover([reef(2.1), reef(2.1)])
    assert cover[7] == pytest.approx(0.105)
    assert reef(2.1).whole.error(cover) == pytest.approx(0.0)


def test_the_error_is_that_of_reefs_left_out():
    reefs = [reef(1.8, 0.9, 0.9), reef(2.0, 1.0, 1.0), reef(2.2, 1.1, 1.1)]
    made = calibrate(reefs, "test")
    errors = np.array([2.1 / 1.8, 2.0 / 2.0, 1.9 / 2.2]) - 1.0
    # Errors of clusters are as large as those of their reefs: nothing is independent.
    assert made.std_m2(1.0) <= math.sqrt(4 / 3 * np.mean(errors**2)) * 1.6
    assert made.std_m2(2.0) == pytest.approx(2.0 * math.sqrt(4 / 3 * np.mean(errors**2)), rel=0.02)
    assert made.reefs == 3


def test_two_reefs_are_too_few():
    with pytest.raises(InputError, match="2 reefs"):
        calibrate([reef(2.0), reef(2.0)], "test")


def test_a_survey_is_compared_with_the_truth(recording):
    def doubtful():
        for one in recording.keyframes():
            yield replace(one, frame=replace(one.frame, doubt=np.full(one.frame.depth.shape, 0.1, np.float32)))

    seen = replace(recording, keyframes=doubtful)
    found = gather_evidence(seen, patch(), CoverCfg())
    assert found.whole.true_m2 == pytest.approx(true_area_m2(patch()), rel=1e-4)
    assert [one.true_m2 for one in found.clusters] == pytest.approx([found.whole.true_m2])
    # Classes are exact: where most votes are for oysters (0.9), shells cover most.
    cover = found.shells / np.maximum(found.hit, 1.0)
    many, few = found.hit * (cover > 0.5), found.hit * (cover < 0.1)
    assert many.sum() > 500
    assert few.sum() > 500
    # Pictures of 80 x 60 leave gaps between pixels, in which shells lie too.
    assert 0.5 * found.whole.true_m2 < found.shells.sum() * 0.02**2 < found.whole.true_m2
    assert found.whole.cells_m2 @ fit_cover([found]) == pytest.approx(found.whole.true_m2)
    with pytest.raises(InputError, match="pictures seen by a network"):
        gather_evidence(recording, patch(), CoverCfg())
