"""Water that is kept up to date, against that of the whole map; what can be reached in it, against the cost-to-go."""

import numpy as np
import pytest

from coral.reef.map.costfield import CostField, CostFieldCfg, slowness_over
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.water import WaterMap
from coral.reef.vehicle.camera import CameraCfg


def whole(cells, cfg):
    return slowness_over(cells.distance(), cells.cfg.cell_m, cfg)


@pytest.mark.parametrize("ratio", [2, 3])
def test_water_is_that_of_the_whole_map_whatever_changes(ratio):
    cfg, rng = CostFieldCfg(ratio=ratio), np.random.default_rng(ratio)
    cells = OccupancyMap((12.05, 9.0), CameraCfg())
    water = WaterMap(cells, cfg)
    ny, nx = cells.obstacle.shape
    np.testing.assert_array_equal(water.now().slowness, whole(cells, cfg))
    for _ in range(40):
        y, x = rng.integers(0, (ny, nx))
        cells.obstacle[y : y + 4, x : x + 4] = rng.random() < 0.7
        np.testing.assert_array_equal(water.now().slowness, whole(cells, cfg))


def test_a_snapshot_stays_as_it_is():
    cells = OccupancyMap((8.0, 8.0), CameraCfg())
    water = WaterMap(cells, CostFieldCfg())
    before = water.snapshot()
    cells.obstacle[80:90, 80:90] = True
    assert (water.now().slowness < 0).sum() > (before.slowness < 0).sum()


def test_what_can_be_reached_is_what_a_cost_to_go_reaches():
    rng, cfg = np.random.default_rng(5), CostFieldCfg()
    cells = OccupancyMap((14.0, 11.0), CameraCfg())
    cells.obstacle[:, 140:146] = True  # a wall from edge to edge
    for y, x in rng.integers(0, cells.obstacle.shape, (14, 2)):
        cells.obstacle[y : y + 6, x : x + 6] = True
    water = WaterMap(cells, cfg).now()
    for x, y in rng.uniform(0.0, (14.0, 11.0), (12, 2)):
        reach, field = water.reach(x, y), CostField.compute(cells.distance(), (x, y), cfg=cfg)
        points = rng.uniform(0.0, (14.0, 11.0), (60, 2))
        assert [reach.reaches(*p) for p in points] == [field.reaches(*p, within_m=0.7) for p in points]


def test_the_way_keeps_from_a_place_and_what_is_blocked_stays_so():
    cells, cfg = OccupancyMap((12.0, 9.0), CameraCfg()), CostFieldCfg()
    cells.obstacle[85:95, 40:45] = True
    water = WaterMap(cells, cfg).now()
    kept = water.kept_from([(6.0, 4.5)], 2.0)
    assert water.kept_from([], 2.0) is water
    assert ((kept.slowness < 0) == (water.slowness < 0)).all()
    way = CostField.over(kept.slowness, (11.0, 4.5), cell_m=kept.cell_m, cfg=cfg).path_from(3.2, 4.5, step_m=0.2)
    assert np.hypot(way[:, 0] - 6.0, way[:, 1] - 4.5).min() > 1.4
