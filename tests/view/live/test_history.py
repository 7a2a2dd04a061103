import numpy as np
import pytest

from coral.view.live.history import History, thinned


def test_a_history_stays_small_and_keeps_its_ends():
    history = History(("a", "b"), limit=64)
    for k in range(1000):
        history.add(0.1 * k, k, -k)
    t, values = history.curves(["b"])
    assert 32 <= len(t) <= 64
    assert (t[0], t[-1]) == (0.0, pytest.approx(99.9, abs=3.2))
    assert np.allclose(values[0], -10 * t)
    assert np.allclose(np.diff(t), t[1] - t[0])


def test_recorded_curves_are_thinned():
    t = np.arange(5000.0)
    few, values = thinned(t, np.stack([t, 2 * t]))
    assert len(few) == 400
    assert (few[0], few[-1]) == (0.0, 4999.0)
    assert (values[1] == 2 * few).all()
