import numpy as np
import pytest

from coral.view.live.strokes import arrow, bundle, crosshair, oval, path, rectangle, ring


def test_strokes():
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0)])
    segments = path(points, 0.5)
    assert segments.tolist() == [[[0, 0, 0.5], [1, 0, 0.5]], [[1, 0, 0.5], [1, 2, 0.5]]]
    assert path(points[:1], 0.5).shape == path(points[:0], 0.5).shape == (0, 2, 3)
    assert bundle(np.stack([points, points + 1]), 0.0).shape == (4, 2, 3)
    assert np.hypot(*(ring(3.0, 4.0, 2.0, 0.0)[:, 0, :2] - (3, 4)).T) == pytest.approx(2.0)
    assert arrow(np.zeros(2), np.array([1.0, 0.0]), 0.0)[0, 1, :2].tolist() == [1.0, 0.0]
    turned = rectangle(np.array([1.0, 1.0]), np.array([2.0, 0.5]), np.pi / 2)
    assert turned[0] == pytest.approx((1.5, -1.0))
    assert oval(np.array([1.0, 1.0]), np.array([2.0, 0.5]), np.pi / 2)[0] == pytest.approx((1.0, 3.0))


def test_a_crosshair_is_a_ring_with_four_arms_around_its_place():
    segments = crosshair(3.0, 4.0, 1.0, 0.2)
    away = np.hypot(*(segments[..., :2].reshape(-1, 2) - (3.0, 4.0)).T)
    assert len(segments) == 32 + 4
    assert (away.min(), away.max()) == (pytest.approx(0.6), pytest.approx(1.5))
    assert (segments[..., 2] == np.float32(0.2)).all()
