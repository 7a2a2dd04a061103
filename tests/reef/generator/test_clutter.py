"""Obstacles of a generated reef, placed in a bare room."""

import itertools
import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.generator.clutter import Clutter, Room, mm
from coral.reef.world.reachability import distance_to, obstacle_outline

START = (3.0, 10.0, 0.0)


def room():
    along = np.arange(3.0, 17.0, 0.5)
    return Room(
        size_m=(20.0, 20.0),
        start=START,
        points=np.stack([along, np.full_like(along, 10.0)], axis=1),
        oysters=np.array([(10.0, 10.0, 0.2), (14.0, 10.0, 0.2)]),
    )


def clutter(seed=1, passage_m=1.0):
    return Clutter(room(), passage_m, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def placed():
    made = clutter()
    made.field(12, 5.0)
    dense = len(made.placed)
    made.along(15, 6.0)
    return made.placed[:dense], made.placed[dense:]


def test_a_passage_remains_between_any_two(placed):
    outlines = [obstacle_outline(o, corners=12) for part in placed for o in part]
    for a, b in itertools.permutations(outlines, 2):
        assert min(distance_to(b, x, y) for x, y in a) >= 1.0 - 2e-3  # places are rounded to the millimetre


def test_the_dense_field_lies_ahead_of_the_start(placed):
    away = [(math.dist((o.x, o.y), START[:2]), o.x) for o in placed[0]]
    assert all(distance <= 5.0 + 2e-3 and x > START[0] - 2e-3 for distance, x in away)


def test_obstacles_along_the_spine_keep_their_distance_from_the_start():
    made = clutter()
    made.along(15, 6.0)
    assert min(math.dist((o.x, o.y), START[:2]) for o in made.placed) >= 6.0 - 2e-3


def test_start_edge_and_oysters_stay_free(placed):
    outlines = [obstacle_outline(o, corners=24) for part in placed for o in part]
    for outline in outlines:
        assert outline.min() > 0.25
        assert outline.max() < 19.75
        assert distance_to(outline, *START[:2]) > 0.85
        assert all(distance_to(outline, x, y) >= reach + 0.3 - 2e-3 for x, y, reach in room().oysters)


def test_what_does_not_fit_even_by_half_is_refused():
    with pytest.raises(InputError, match="passages of 3 m") as caught:
        clutter(passage_m=3.0).field(8, 2.5)
    assert (caught.value.where, caught.value.found) == ("--dense-obstacles", 8)


def test_a_spine_that_stays_near_its_start_has_no_room_beyond():
    with pytest.raises(InputError, match="stays within 30 m of its start"):
        clutter().along(5, 30.0)


@pytest.mark.parametrize(("value", "kept"), [(1.23449, 1.234), (-0.0016, -0.002), (np.float64(2.0), 2.0)])
def test_lengths_are_kept_to_the_millimetre(value, kept):
    assert mm(value) == kept
    assert type(mm(value)) is float
