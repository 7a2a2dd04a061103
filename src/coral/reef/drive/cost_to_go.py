"""The cost-to-go that the vehicle follows: renewed for a new goal, and every second while the map changes."""

from __future__ import annotations

import math

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.question import Withdrawn
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.water import Water


class CostToGo:
    """Keeps the cost-to-go from where the robot is to its goal.

    One that searches more than `most_cells` is computed on the clock's preparation thread, from the map as it was when
    it was asked for; until it is there, the vehicle follows the last one.
    """

    def __init__(
        self,
        belief: Belief,
        clock: SimulatedClock | WallClock,
        cfg: CostFieldCfg,
        *,
        period_s: float,
        most_cells: int,
        prepare_s: float,
        straight: bool = False,
    ) -> None:
        """Set up that of one robot, renewed at most every `period_s` (s) while only the map changes.

        A search of more cells than `most_cells` takes `prepare_s` of simulated time (s). `straight`: by the straight
        distance to the goal, whatever lies between.
        """
        self.field: CostField | None = None
        """None before the first update."""
        self._belief, self._clock, self._cfg = belief, clock, cfg
        self._period_s, self._most_cells, self._prepare_s = period_s, most_cells, prepare_s
        self._straight = straight
        self._key: tuple[tuple[float, float], int, tuple[tuple[float, float], ...]] | None = None
        self._at_s = -math.inf
        self._asked = 0
        self._led_to: tuple[float, float] | None = None

    def update(self, t: float) -> bool:
        """Renew the cost-to-go if it is time. Return whether it now leads to another goal than at the last call."""
        belief, goal = self._belief, self._belief.goal
        assert goal is not None
        key = (goal, belief.map.version, belief.unchosen)
        if self._key is None or self._key[0] != goal or (key != self._key and t - self._at_s >= self._period_s - 1e-9):
            self._key, self._at_s = key, t
            self._asked += 1
            if self._straight:
                self.field = CostField.straight(belief.map.obstacle.shape, goal, cell_m=belief.map.cfg.cell_m)
                return self._leads_elsewhere()
            water, start = belief.water(self._cfg).kept_from(belief.unchosen, belief.clear_m), belief.pose[:2]
            field = self._search(water, start, goal, None if self.field is None else self._most_cells)
            if field is None:
                self._clock.start(self._search_far(water, start, goal))
            else:
                self.field = field
        return self._leads_elsewhere()

    def _leads_elsewhere(self) -> bool:
        if self.field is None or self.field.goal == self._led_to:
            return False
        self._led_to = self.field.goal
        return True

    def _search(
        self, water: Water, start: tuple[float, float], goal: tuple[float, float], most_cells: int | None
    ) -> CostField | None:
        return CostField.between(water.slowness, start, goal, cell_m=water.cell_m, cfg=self._cfg, most_cells=most_cells)

    async def _search_far(self, water: Water, start: tuple[float, float], goal: tuple[float, float]) -> None:
        """Search on the preparation thread. The result counts unless another one has been asked for since."""
        number = self._asked
        try:
            field = await self._clock.prepare(lambda: self._search(water, start, goal, None), self._prepare_s)
        except Withdrawn:
            self._key = None
            return
        if number == self._asked:
            self.field = field
