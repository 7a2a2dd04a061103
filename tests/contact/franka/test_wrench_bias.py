"""The bias is a mean over readings, and only holds once enough were taken."""

import numpy as np
import pytest

from coral.contact.franka.wrench_bias import WrenchBias


def test_the_mean_of_the_readings_is_subtracted():
    bias = WrenchBias(2)
    bias.add(np.full(6, 1.0))
    assert not bias.known
    assert bias.corrected(np.full(6, 5.0)) == pytest.approx(np.full(6, 5.0))
    bias.add(np.full(6, 3.0))
    assert bias.known
    assert bias.corrected(np.full(6, 5.0)) == pytest.approx(np.full(6, 3.0))
