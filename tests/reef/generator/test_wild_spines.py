"""Large reefs drawn at random: inside the world, apart from one another, and different from seed to seed."""

import numpy as np
import pytest

from coral.reef.generator.wild_spines import APART_M, GAP_M, WILD, patchy, scatter

SIZE = (40.0, 40.0)


@pytest.mark.parametrize("name", sorted(WILD))
def test_lines_lie_inside_the_world_and_repeat_with_the_seed(name):
    lines = WILD[name](SIZE, np.random.default_rng(5))
    again = WILD[name](SIZE, np.random.default_rng(5))
    other = WILD[name](SIZE, np.random.default_rng(6))
    assert all(np.array_equal(a, b) for a, b in zip(lines, again, strict=True))
    assert len(lines) != len(other) or not np.array_equal(lines[0], other[0])
    points = np.concatenate(lines)
    assert (points > 0.0).all()
    assert (points < np.array(SIZE)).all()
    assert len(lines) >= 3


def test_patches_lie_farther_apart_than_a_robot_sees():
    lines = patchy(SIZE, np.random.default_rng(5))
    gaps = [
        np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)).min() for k, a in enumerate(lines) for b in lines[k + 1 :]
    ]
    assert min(gaps) > GAP_M[0] - 1.0 > APART_M


def test_points_are_scattered_as_far_apart_as_their_number_allows():
    line = np.array([(0.0, 0.0), (12.0, 0.0)])
    places = scatter([line], 3, lead_m=2.0)
    assert [place[0] for place in places] == pytest.approx([2.0, 7.0, 11.9], abs=0.2)
    assert all(place[2] == 0.0 for place in places)
    assert scatter([line], 3, lead_m=20.0) == []
