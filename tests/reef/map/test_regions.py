"""Regions of a growing map, against those of a map that is labelled as a whole."""

import numpy as np
import pytest

from coral.reef.map.chain import ChainCfg, components
from coral.reef.map.regions import OysterRegions

CELL_M, CFG = 0.05, ChainCfg(min_area_px=20)


def described(found):
    """Values of components in an order of their own."""
    return sorted((round(c.x, 9), round(c.y, 9), c.area_px, c.length_m, sorted(map(tuple, c.cells))) for c in found)


@pytest.mark.parametrize("seed", range(6))
def test_a_map_that_changes_bit_by_bit_has_the_regions_of_the_whole(seed):
    rng = np.random.default_rng(seed)
    target = np.zeros((160, 200), np.bool_)
    regions = OysterRegions(target, CELL_M, CFG)
    for _ in range(60):
        y, x = rng.integers(0, (160, 200))
        high, wide = rng.integers(1, 14, 2)
        # Patches join regions and, taken away again, split them; some touch the map's edge.
        target[y : y + high, x : x + wide] = rng.random() < 0.7
        assert described(regions.update()) == described(components(target, CELL_M, CFG))


def test_a_region_far_from_a_change_is_not_labelled_again():
    target = np.zeros((100, 100), np.bool_)
    target[5:15, 5:15] = True
    regions = OysterRegions(target, CELL_M, CFG)
    (before,) = regions.update()
    target[60:75, 60:75] = True
    after = regions.update()
    assert len(after) == 2
    assert after[0] is before


def test_a_region_that_goes_is_forgotten():
    target = np.zeros((50, 50), np.bool_)
    target[5:15, 5:15] = True
    regions = OysterRegions(target, CELL_M, CFG)
    assert len(regions.update()) == 1
    target[:] = False
    assert regions.update() == []


@pytest.mark.parametrize("seed", range(4))
def test_sparse_oysters_that_closing_joins_have_the_regions_of_the_whole(seed):
    """A window's edge can cut a region off at a part that closing alone has made, without an oyster cell."""
    rng = np.random.default_rng(seed)
    target = np.zeros((90, 120), np.bool_)
    regions = OysterRegions(target, CELL_M, CFG)
    for _ in range(150):
        y, x = rng.integers(0, (90, 120))
        target[y, x] = rng.random() < 0.9
        target[y, min(x + 7, 119)] = True
        assert described(regions.update()) == described(components(target, CELL_M, CFG))
