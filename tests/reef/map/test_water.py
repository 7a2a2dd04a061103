"""What can be reached in the water, against the cost-to-go, and the way through it."""

import numpy as np
from given_fields import field_to

from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.water import Water
from coral.reef.vehicle.camera import CameraCfg


def test_what_can_be_reached_is_what_a_cost_to_go_reaches():
    rng, cfg = np.random.default_rng(5), CostFieldCfg()
    cells = OccupancyMap((14.0, 11.0), CameraCfg())
    cells.obstacle[:, 140:146] = True  # a wall from edge to edge
    for y, x in rng.integers(0, cells.obstacle.shape, (14, 2)):
        cells.obstacle[y : y + 6, x : x + 6] = True
    water = Water.over(cells.distance(), cells.cfg.cell_m, cfg)
    for x, y in rng.uniform(0.0, (14.0, 11.0), (12, 2)):
        reach, field = water.reach(x, y), field_to((x, y), cells.distance(), cfg=cfg)
        points = rng.uniform(0.0, (14.0, 11.0), (60, 2))
        assert [reach.reaches(*p) for p in points] == [field.reaches(*p, within_m=0.7) for p in points]


def test_the_way_keeps_from_a_place_and_what_is_blocked_stays_so():
    cells, cfg = OccupancyMap((12.0, 9.0), CameraCfg()), CostFieldCfg()
    cells.obstacle[85:95, 40:45] = True
    water = Water.over(cells.distance(), cells.cfg.cell_m, cfg)
    kept = water.kept_from([(6.0, 4.5)], 2.0)
    assert water.kept_from([], 2.0) is water
    assert ((kept.slowness < 0) == (water.slowness < 0)).all()
    way = CostField.over(kept.slowness, (11.0, 4.5), cell_m=kept.cell_m, cfg=cfg).path_from(3.2, 4.5, step_m=0.2)
    assert np.hypot(way[:, 0] - 6.0, way[:, 1] - 4.5).min() > 1.4
