"""Features and outlines."""

import numpy as np

from coral.reef.products.feature import Feature, Layer, closed_ring


def test_a_ring_is_closed_and_counter_clockwise():
    clockwise = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])
    ring = closed_ring(clockwise)
    np.testing.assert_array_equal(ring[0], ring[-1])
    assert len(ring) == 5
    assert ring[1].tolist() == [1.0, 0.0]
    np.testing.assert_array_equal(closed_ring(ring), ring)


def test_an_empty_layer_knows_its_columns():
    assert Layer("x", "Point", (), columns=("a",)).attributes == ("a",)
    assert Layer("x", "Point", (Feature((), {"b": 1}),), columns=("a",)).attributes == ("b",)
