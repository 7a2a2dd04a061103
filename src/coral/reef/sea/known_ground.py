"""What a map says of the seabed, in the form in which two maps are compared: masks, sample points, standing bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.map.chain import ChainCfg, closing_width
from coral.reef.map.mapping import OccupancyMap

OBSTACLE, OYSTER, BARE = 0, 1, 2
"""Kinds of ground."""
KINDS = (OBSTACLE, OYSTER, BARE)
SPACING_M = (0.1, 0.15, 0.5)
"""Distance between sample points of each kind: what lies nearer together was seen in the same pictures."""
BODY_CELLS = 12
"""Fewest cells of a body: 0.03 m²."""


@dataclass(frozen=True)
class KnownGround:
    """The kinds of the seen cells of a map."""

    masks: NDArray[np.bool_]
    """Cells of each kind. Shape=(3, NY, NX)."""
    cell_m: float

    @classmethod
    def of_map(cls, cells: OccupancyMap, forbidden: NDArray[np.bool_]) -> KnownGround:
        """Copy what a map shows.

        Args:
            cells: The map.
            forbidden: Cells that are closed by a fence, which nobody has seen. Shape=(NY, NX).
        """
        obstacle = cells.obstacle & ~forbidden
        oyster = cells.target & ~obstacle & ~forbidden
        bare = cells.explored & ~obstacle & ~oyster & ~forbidden
        return cls(np.stack([obstacle, oyster, bare]), cells.cfg.cell_m)

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Cells of which the kind is known. Shape=(NY, NX)."""
        return np.asarray(self.masks.any(axis=0))

    def points(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return places of every kind (m), Shape=(N, 2), and their kinds, Shape=(N,)."""
        places, kinds = [], []
        for kind, spacing_m in zip(KINDS, SPACING_M, strict=True):
            at = np.argwhere(self.masks[kind])
            box = np.floor_divide(at, max(1, round(spacing_m / self.cell_m)))
            first = np.unique(box, axis=0, return_index=True)[1]
            places.append((at[first][:, ::-1] + 0.5) * self.cell_m)
            kinds.append(np.full(len(first), kind, np.int64))
        return np.concatenate(places), np.concatenate(kinds)

    def bodies(self) -> Sequence[tuple[int, NDArray[np.float64]]]:
        """Return the obstacles and oyster clusters one by one: kind, and centres of the cells (m), Shape=(M, 2)."""
        found: list[tuple[int, NDArray[np.float64]]] = []
        width = closing_width(self.cell_m, ChainCfg())
        kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
        for kind in (OBSTACLE, OYSTER):
            mask = self.masks[kind].astype(np.uint8)
            joined = mask if kind == OBSTACLE else cv2.morphologyEx(mask, cv2.MORPH_CLOSE, kernel)
            count, labels = cv2.connectedComponents(joined, connectivity=8)
            at = np.argwhere(self.masks[kind])
            of = labels[at[:, 0], at[:, 1]]
            for k in range(1, count):
                cells = at[of == k]
                if len(cells) >= BODY_CELLS:
                    found.append((kind, np.asarray((cells[:, ::-1] + 0.5) * self.cell_m, np.float64)))
        return found
