"""The fit of a response to step responses with known numbers."""

import numpy as np
import pytest

from coral.errors import RunError
from coral.reef.sea.step_response import fit_step_response, lagged

AT = np.arange(0.0, 40.0, 0.1)
COMMAND = np.where((AT > 2) & (AT < 10), 0.5, np.where((AT > 20) & (AT < 28), 0.3, 0.0))
T = np.arange(0.0, 40.0, 0.05)


def test_a_lagged_step_in_closed_form():
    y = lagged(np.array([0.5, 1.5]), np.array([0.0]), np.array([2.0]), 0.5, 1.0)
    assert y == pytest.approx([0.0, 2.0 * (1 - np.exp(-1))])


def test_a_single_lag_is_found():
    rng = np.random.default_rng(0)
    y = 0.85 * lagged(T, AT, COMMAND, 0.4, 0.2) + rng.normal(0.0, 0.01, len(T))
    found = fit_step_response(T, y, AT, COMMAND, trails=False)
    assert found.gain == pytest.approx(0.85, abs=0.01)
    assert (found.lag_s, found.delay_s) == (pytest.approx(0.4, abs=0.05), pytest.approx(0.2, abs=0.05))
    assert found.error == pytest.approx(0.01, rel=0.2)


def test_a_trailing_share_is_found():
    y = 0.64 * lagged(T, AT, COMMAND, 0.1, 0.1) + 0.16 * lagged(T, AT, COMMAND, 4.0, 0.1)
    found = fit_step_response(T, y, AT, COMMAND, trails=True)
    assert found.gain == pytest.approx(0.8, abs=0.01)
    assert (found.trail, found.trail_lag_s) == (pytest.approx(0.2, abs=0.02), 4.0)


def test_a_vehicle_that_stands_is_told():
    with pytest.raises(RunError, match="did not follow its set-points"):
        fit_step_response(T, np.zeros_like(T), AT, COMMAND, trails=True)
