"""Clusters with outline, area and how they were seen."""

import numpy as np
import pytest

from coral.reef.map.chain import ChainCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.products.clusters import label_clusters, measure_clusters
from coral.reef.products.cover import Cover
from coral.reef.vehicle.camera import CameraCfg


@pytest.fixture
def cells():
    made = OccupancyMap((4.0, 3.0), CameraCfg())
    made.target[10:20, 10:30] = True  # 0.5 x 1 m
    made.target[40:52, 50:60] = True  # 0.6 x 0.5 m
    made.target[55, 5] = True  # one cell is no cluster
    return made


def test_regions_are_numbered_from_the_south_with_what_lies_beside_them(cells):
    group = label_clusters(cells, ChainCfg(), 0.1)
    assert set(np.unique(group)) == {0, 1, 2}
    assert group[15, 20] == 1
    assert group[45, 55] == 2
    assert group[8, 20] == 1
    assert group[7, 20] == 0


def test_a_cluster_is_measured_within_its_outline(cells):
    share = np.zeros((150, 200), np.float32)
    share[25:50, 25:75] = 0.5  # half of 0.5 x 1 m
    cover = Cover(share, share, np.ones_like(share, bool))
    cells.nearest[:] = 2.0
    group = label_clusters(cells, ChainCfg(), 0.1)
    first, second = measure_clusters(cells, group, np.full((60, 80), 7, np.uint16), cover, [], ChainCfg())
    assert (first.area.value, first.outline_m2, first.cover) == pytest.approx((0.25, 0.5, 0.5), rel=1e-3)
    assert (first.x, first.y) == pytest.approx((1.0, 0.75))
    assert (first.seen_from_m, first.looks) == (2.0, 7)
    assert first.pixel_m == pytest.approx(2.0 / cells.focal_px)
    assert second.area.value == 0.0
    (ring,) = first.outlines
    assert ring.min(axis=0) == pytest.approx((0.5, 0.5), abs=0.01)
    assert ring.max(axis=0) == pytest.approx((1.5, 1.0), abs=0.01)


def test_a_map_without_oysters_has_no_clusters():
    assert not label_clusters(OccupancyMap((2.0, 2.0), CameraCfg()), ChainCfg(), 0.1).any()
