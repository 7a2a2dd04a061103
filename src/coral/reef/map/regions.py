"""The connected oyster regions of a growing map: labelled again only where oyster cells have changed."""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.chain import ChainCfg, Component, closing_width, label_regions
from coral.reef.map.changes import Box, ChangeTracker, grown, joined, meet


class OysterRegions:
    """Keeps the `components` of a map.

    A changed cell can change the closed mask within the width of its structuring element. A region that does not touch
    this neighbourhood stays as it is; all others lie, before and after, inside the neighbourhood and their own
    rectangles. Only these are labelled again, so the result is the same as if the whole map were.
    """

    def __init__(self, target: NDArray[np.bool_], cell_m: float, cfg: ChainCfg) -> None:
        """Follow a mask of oyster cells, Shape=(NY, NX), of `cell_m` metres each."""
        self._target, self._cell_m, self._cfg = target, cell_m, cfg
        self._changes = ChangeTracker(target)
        self._regions: list[tuple[Component, Box]] = []
        self._found: list[Component] = []

    def update(self) -> list[Component]:
        """Return the regions of at least A_min on the present map, from the top row down."""
        changed = self._changes.take()
        if changed is None:
            return self._found
        shape = self._target.shape
        around = grown(changed, closing_width(self._cell_m, self._cfg), shape)
        reach = grown(around, 1, shape)
        touched = [region for region in self._regions if meet(region[1], reach)]
        kept = [region for region in self._regions if not meet(region[1], reach)]
        window = reduce(joined, (box for _, box in touched), around)
        y0, y1, x0, x1 = window
        before = np.zeros((y1 - y0, x1 - x0), np.bool_)
        for component, _ in touched:
            before[component.cells[:, 0] - y0, component.cells[:, 1] - x0] = True
        for component, box in label_regions(self._target, window, self._cell_m, self._cfg):
            # Others are parts of regions that stay, cut at the window's edge; some of these without an oyster cell.
            if not len(component.cells):
                continue
            if meet(box, around) or before[component.cells[0, 0] - y0, component.cells[0, 1] - x0]:
                kept.append((component, box))
        self._regions = sorted(kept, key=lambda region: (region[1][0], region[1][2]))
        self._found = [component for component, _ in self._regions if component.area_px >= self._cfg.min_area_px]
        return self._found
