import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.pilot.stops import (
    Sightings,
    greedy_cover,
    neighbours,
    order_stops,
    rearranged,
    shifted,
    unturned,
    without,
)


def sightings(table):
    return Sightings.of([np.flatnonzero(row) for row in table], np.shape(table)[1])


def test_a_cover_has_everything_and_begins_with_the_row_that_adds_most():
    seen = sightings(np.array([[1, 1, 0, 0], [0, 1, 1, 1], [0, 0, 0, 1], [0, 0, 0, 0]]))
    assert greedy_cover(seen, np.ones(4)) == [1, 0]
    # The first column is worth more than the three others together.
    assert greedy_cover(seen, np.array([10.0, 1, 1, 1])) == [0, 1]
    assert greedy_cover(sightings(np.zeros((3, 0))), np.zeros(0)) == []


def test_columns_without_worth_are_covered_too():
    assert greedy_cover(sightings(np.eye(3)), np.array([1.0, 0.0, 0.0])) == [0, 1, 2]


@given(st.lists(st.lists(st.booleans(), min_size=5, max_size=5), min_size=1, max_size=6), st.integers(0, 6))
def test_sightings_equal_a_dense_table(rows, cut):
    table, weight = np.array(rows), np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    parts = [sightings(part) for part in (table[:cut], table[cut:]) if len(part)]
    joined = Sightings.together(parts)
    assert joined.worth(weight).tolist() == (table @ weight).tolist()
    assert joined.seen().tolist() == table.any(axis=0).tolist()
    assert [joined.row(v).tolist() for v in range(len(table))] == [np.flatnonzero(row).tolist() for row in table]


def distances(points):
    places = np.array(points, float)
    return np.linalg.norm(places[:, None] - places[None, 1:], axis=2)


def test_stops_along_a_line_are_visited_in_order():
    assert order_stops(distances([(0, 0), (3, 0), (1, 0), (4, 0), (2, 0)])) == [1, 3, 0, 2]
    assert order_stops(np.empty((1, 0))) == []


def test_an_order_that_greed_spoils_is_mended():
    """Nearest neighbour goes 1 left first, then 5 right, then 16 back; turning at the near end saves 4."""
    table = distances([(0, 0), (-1, 0), (1.5, 0), (-3.5, 0), (6, 0)])
    order = order_stops(table)
    length = sum(table[a, b] for a, b in zip([0, *(k + 1 for k in order)], order, strict=False))
    assert length == 3.5 + 3.5 + 6.0


def test_neighbours_hold_the_same_stops():
    found = list(neighbours([0, 1, 2, 3]))
    assert all(sorted(route) == [0, 1, 2, 3] for route in found)
    assert [0, 2, 1, 3] in found
    assert [2, 3, 0, 1] in found


def test_changes_of_a_route():
    route = [(0.0, 0.0, math.nan), (2.0, 0.0, 1.0)]
    assert [len(changed) for changed in without(route)] == [1, 1]
    (straight,) = unturned(route)
    assert math.isnan(straight[1][2])
    assert [(2.0, 0.0, 1.0), route[0]] in list(rearranged(route))
    moved = list(shifted(route))
    assert len(moved) == 16
    changes = [math.dist(new[:2], old[:2]) for r in moved for new, old in zip(r, route, strict=True)]
    assert {round(change, 2) for change in changes} == {0.0, 0.5}
