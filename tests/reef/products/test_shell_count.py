"""Shells drawn by hand and thrown at random."""

import cv2
import numpy as np
import pytest

from coral.reef.products.shell_count import count_bulges, count_shells, find_singles

CELL_M = 0.02


def drawn(shells, shape=(400, 400), fine=5):
    """Share of each cell under ellipses (x, y, half length, half width, angle) in metres."""
    image = np.zeros((shape[0] * fine, shape[1] * fine), np.uint8)
    for x, y, a, b, angle in shells:
        scale = fine / CELL_M
        cv2.ellipse(
            image, (round(x * scale), round(y * scale)), (round(a * scale), round(b * scale)), angle, 0, 360, 255, -1
        )
    return cv2.resize(image, shape[::-1], interpolation=cv2.INTER_AREA).astype(np.float32) / np.float32(255.0)


def thrown(rng, count, corner=(1.0, 1.0), size=5.0):
    places = np.array(corner) + rng.uniform(0.0, size, (count, 2))
    halves = rng.uniform(0.06, 0.13, count)
    return [
        (*place, half, 0.7 * half, float(angle))
        for place, half, angle in zip(places, halves, rng.uniform(0, 360, count), strict=True)
    ]


def test_the_size_of_one_that_lies_apart():
    found = find_singles(drawn([(2.0, 3.0, 0.1, 0.07, 30.0)]), CELL_M)
    assert (found.x[0], found.y[0]) == (pytest.approx(2.0, abs=0.01), pytest.approx(3.0, abs=0.01))
    assert found.length[0] == pytest.approx(0.2, rel=0.06)
    assert found.width[0] == pytest.approx(0.14, rel=0.1)
    assert found.area[0] == pytest.approx(np.pi * 0.1 * 0.07, rel=0.1)


def test_two_that_touch_are_no_single_one_and_two_outlines():
    pair = drawn([(2.0, 3.0, 0.1, 0.07, 0.0), (2.18, 3.0, 0.1, 0.07, 0.0), (5.0, 5.0, 0.1, 0.07, 0.0)])
    assert len(find_singles(pair, CELL_M).area) == 1
    assert count_bulges(pair >= 0.5) == 3
    specks = (pair >= 0.5) | (np.arange(pair.size).reshape(pair.shape) % 37 == 0) & (pair == 0.0)
    assert count_bulges(specks) == pytest.approx(3, abs=1)
    assert count_bulges(np.zeros((9, 9), bool)) == 0


def test_the_number_includes_those_that_others_hide():
    ratios = []
    for seed in (1, 2, 3):
        rng = np.random.default_rng(seed)
        shells = thrown(rng, 500) + thrown(rng, 40, (0.5, 6.5), 1.0)
        share = drawn(shells)
        found = count_shells(share, share, CELL_M, 0.03)
        assert found.outlines.high < 540
        assert found.oysters.low < 540 < found.oysters.high
        assert found.length.value == pytest.approx(np.mean([2 * one[2] for one in shells]), rel=0.1)
        ratios.append(found.oysters.value / 540)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.12)


def test_what_is_not_seen_makes_the_interval_no_narrower_and_few_shells_tell_nothing():
    share = drawn(thrown(np.random.default_rng(5), 60, size=6.0))
    narrow, wide = (count_shells(share, share, CELL_M, error) for error in (0.0, 0.2))
    assert wide.oysters.high - wide.oysters.low > narrow.oysters.high - narrow.oysters.low
    few = count_shells(*(2 * [drawn([(2.0, 3.0, 0.1, 0.07, 30.0)])]), CELL_M)
    assert len(few.singles.area) == 1
    assert (few.outlines, few.oysters, few.length) == (None, None, None)
