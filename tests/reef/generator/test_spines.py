"""The lines along which a reef grows, and places along them."""

import math

import numpy as np
import pytest

from coral.reef.generator.spines import samples, spread, topology_lines


def test_arms_of_the_k_diverge_from_its_node():
    stem, *arms = topology_lines("K", (20.0, 20.0))
    assert len(arms) == 2
    for arm in arms:
        assert stem[0, 1] < arm[0, 1] < stem[1, 1]
        assert arm[0, 0] == stem[0, 0]
    turns = [math.degrees(math.atan2(*(arm[1] - arm[0])[::-1])) for arm in arms]
    assert abs(turns[0] - turns[1]) > 50.0


@pytest.mark.parametrize("topology", "LSKEO")
def test_lines_scale_with_the_world_and_stay_inside(topology):
    small, large = topology_lines(topology, (10.0, 20.0)), topology_lines(topology, (20.0, 40.0))
    for line, twice in zip(small, large, strict=True):
        np.testing.assert_allclose(2.0 * line, twice)
        assert line.min() > 0.0
        assert (line < (10.0, 20.0)).all()


def test_samples_lie_a_tenth_of_a_metre_apart_on_every_line():
    points = samples([np.array([(0.0, 0.0), (0.3, 0.0)]), np.array([(0.0, 1.0), (0.0, 1.2)])])
    np.testing.assert_allclose(points, [(0, 0), (0.1, 0), (0.2, 0), (0.3, 0), (0, 1), (0, 1.1), (0, 1.2)], atol=1e-12)


def test_places_are_even_along_a_line_and_reach_the_tips():
    stem, branch = np.array([(0.0, 0.0), (0.0, 14.0)]), np.array([(0.0, 7.0), (8.0, 7.0)])
    places = spread([stem, branch], 5, lead_m=2.0)
    assert [place[:2] for place in places] == [pytest.approx(p) for p in [(0, 2), (0, 8), (0, 14), (4, 7), (8, 7)]]
    assert places[0][2] == pytest.approx(math.pi / 2)


def test_places_on_a_loop_do_not_meet_at_its_end():
    angles = np.linspace(0.0, 2 * math.pi, 73)
    loop = np.stack([5.0 * np.cos(angles), 5.0 * np.sin(angles)], axis=1)
    places = np.array(spread([np.concatenate([[(5.0, -4.0)], loop])], 6, lead_m=2.0))[:, :2]
    away = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + 99.0 * np.eye(6)
    assert away.min(axis=1) == pytest.approx(5.0, abs=0.15)
