"""Oyster clusters as an ecologist counts them: outline, area with its interval, how well each was seen."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.map.chain import ChainCfg, closing_width, components
from coral.reef.map.mapping import OccupancyMap
from coral.reef.products.cover import Cover, SurveyEstimate, area_within, fine_of, nearest_in


@dataclass(frozen=True, kw_only=True)
class ClusterProduct:
    """One cluster."""

    number: int
    """From 1 on, from south to north."""
    x: float
    y: float
    """Centroid in the map (m)."""
    area: SurveyEstimate
    """Area that shells cover (m²)."""
    outline_m2: float
    """Area within its outline, gaps between shells included."""
    outlines: tuple[NDArray[np.float64], ...]
    """Closed outlines (m). Shape=(N, 2) each."""
    seen_from_m: float
    """Distance from which its oyster cells were seen, the nearest look of each; median (m)."""
    pixel_m: float
    """Size of a pixel at that distance (m)."""
    looks: int
    """Pictures that show a cell of it; median."""

    @property
    def cover(self) -> float:
        """Share of its outline that shells cover."""
        return min(self.area.value / self.outline_m2, 1.0)


def label_clusters(cells: OccupancyMap, cfg: ChainCfg, beside_m: float) -> NDArray[np.int32]:
    """Number the clusters of a map: 1, 2, ... for the cells within `beside_m` of a cluster's oysters, 0 elsewhere.

    Clusters are the regions that the robot's own centroid chain is made of (paper III-B). Shape=(NY, NX).
    """
    cell_m = cells.cfg.cell_m
    regions = components(cells.target, cell_m, cfg)
    group = np.zeros(cells.target.shape, np.int32)
    for number, component in enumerate(regions, 1):
        group[component.cells[:, 0], component.cells[:, 1]] = number
    if not regions:
        return group
    away, nearest = nearest_in(group > 0)
    return np.where(away * cell_m <= beside_m + 1e-6, group.ravel()[nearest], 0).astype(np.int32)


def measure_clusters(
    cells: OccupancyMap, group: NDArray[np.int32], looks: NDArray[np.uint16], cover: Cover, without: list[Cover],
    cfg: ChainCfg,
) -> list[ClusterProduct]:  # fmt: skip
    """Measure every cluster of `label_clusters`."""
    cell_m = cells.cfg.cell_m
    width = closing_width(cell_m, cfg)
    kernel = np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width)), np.uint8)
    made = []
    for number in range(1, int(group.max()) + 1):
        near = group == number
        oysters = cells.target & near
        closed = _closed(oysters, kernel)
        iy, ix = np.nonzero(closed)
        away = cells.nearest[oysters]
        seen_from = float(np.median(away[np.isfinite(away)])) if np.isfinite(away).any() else float("nan")
        made.append(
            ClusterProduct(
                number=number,
                x=float((ix.mean() + 0.5) * cell_m),
                y=float((iy.mean() + 0.5) * cell_m),
                area=area_within(cover, without, fine_of(near, cell_m, cover)),
                outline_m2=float(len(ix)) * cell_m**2,
                outlines=tuple(_outlines(closed, cell_m)),
                seen_from_m=seen_from,
                pixel_m=seen_from / cells.focal_px,
                looks=int(np.median(looks[oysters])),
            )
        )
    return made


def _closed(oysters: NDArray[np.bool_], kernel: NDArray[np.uint8]) -> NDArray[np.bool_]:
    pad = kernel.shape[0]
    grown = np.pad(oysters.astype(np.uint8), pad)
    return cv2.morphologyEx(grown, cv2.MORPH_CLOSE, kernel)[pad:-pad, pad:-pad].astype(np.bool_)


def _outlines(mask: NDArray[np.bool_], cell_m: float) -> list[NDArray[np.float64]]:
    """Return the outer outlines of a mask along the edges of its cells (m). Shape=(N, 2) each."""
    fine = 4  # an outline runs through the centres of pixels: an eighth of a cell inside the edge
    iy, ix = np.nonzero(mask)
    if not len(iy):
        return []
    y0, x0 = int(iy.min()), int(ix.min())
    part = mask[y0 : iy.max() + 1, x0 : ix.max() + 1].astype(np.uint8)
    grown = np.kron(part, np.ones((fine, fine), np.uint8))
    contours, _ = cv2.findContours(grown, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    rings = [contour.reshape(-1, 2).astype(np.float64) for contour in contours if len(contour) >= 3]
    return [((ring + 0.5) / fine + (x0, y0)) * cell_m for ring in rings]
