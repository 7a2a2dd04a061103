"""Rectangles of change, against a comparison of the whole mask."""

import numpy as np
import pytest

from coral.reef.map.changes import ChangeTracker, meet


def test_the_rectangle_holds_every_change_and_no_more():
    mask = np.zeros((40, 60), np.bool_)
    changes = ChangeTracker(mask)
    rng = np.random.default_rng(0)
    kept = mask.copy()
    assert changes.take() is None
    for _ in range(50):
        at = rng.integers(0, (40, 60), (3, 2))
        mask[at[:, 0], at[:, 1]] ^= True
        iy, ix = np.nonzero(mask != kept)
        expected = (iy.min(), iy.max() + 1, ix.min(), ix.max() + 1) if len(iy) else None
        assert changes.take() == expected
        kept = mask.copy()
    assert changes.take() is None


def test_the_first_look_finds_what_is_there():
    mask = np.zeros((5, 5), np.bool_)
    mask[2, 3] = True
    assert ChangeTracker(mask).take() == (2, 3, 3, 4)


@pytest.mark.parametrize(("other", "shared"), [((2, 4, 2, 4), True), ((3, 4, 0, 9), False), ((0, 9, 3, 4), False)])
def test_rectangles_meet_where_they_share_a_cell(other, shared):
    assert meet((0, 3, 0, 3), other) is shared
