"""Cost-to-go over a map of which only the distances to obstacles are given."""

from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.water import Water


def field_to(goal, distance, *, start=None, cfg=None, cell_m=0.05):
    """Return the cost-to-go over a map, Shape=(H, W), as missions have it."""
    water = Water.over(distance, cell_m, cfg or CostFieldCfg())
    return CostField.over(water.slowness, goal, start=start, cell_m=water.cell_m, cfg=water.cfg)
