"""All that is measured from a recording, before it becomes files."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.map.chain import ChainCfg
from coral.reef.map.mapping import OccupancyMap, distance_to
from coral.reef.products.best_pictures import ClusterPicture, best_pictures
from coral.reef.products.clusters import ClusterProduct, label_clusters, measure_clusters
from coral.reef.products.cover import (
    BESIDE_M,
    CONFIRMED,
    FINE_M,
    SurveyEstimate,
    area_within,
    fine_of,
    larger_cells,
    measure_cover,
)
from coral.reef.products.judgement import Judgement, judge
from coral.reef.products.mosaic import Mosaic, MosaicCfg, make_mosaic
from coral.reef.products.picture_labels import LabelsCfg
from coral.reef.products.seen_points import count_looks, grid_shape
from coral.reef.products.shell_count import ShellCount, count_shells
from coral.reef.recordings.recording import Recording, map_of

DENSITY_CELL_M = 0.5
"""Edge of a cell of the density map."""
_LEAST_KNOWN = 0.2
"""Share of a cell that must be known for its mean."""


@dataclass(frozen=True, kw_only=True)
class ProductsCfg:
    """How products are made of a recording."""

    mosaic: MosaicCfg = field(default_factory=MosaicCfg)
    clusters: ChainCfg = field(default_factory=ChainCfg)
    labels: LabelsCfg = field(default_factory=LabelsCfg)


@dataclass(frozen=True)
class SurveyProducts:
    """What was measured. Arrays over the map have row 0 in the south."""

    recording: Recording
    """Located."""
    cfg: ProductsCfg
    keyframes: int
    cells: OccupancyMap
    area: SurveyEstimate
    """Of all oysters (m²), those outside clusters included."""
    shells: ShellCount
    """How many oysters those are, and how long."""
    judgement: Judgement
    calibrated_reefs: int
    """Reefs on which the network that saw the pictures was calibrated; 0 where no calibration was used."""
    clusters: tuple[ClusterProduct, ...]
    cover: NDArray[np.float32]
    """Share of oysters in each map cell, nan where not seen near enough. Shape=(NY, NX)."""
    density: NDArray[np.float32]
    """Oysters per sea floor seen, in coarse cells (m²/m²); nan where less than a fifth was seen. Shape=(DY, DX)."""
    seen: NDArray[np.bool_]
    """Sea floor seen near enough to count, in fine cells. Shape=(FY, FX)."""
    looks: NDArray[np.uint16]
    """Number of pictures that show each map cell. Shape=(NY, NX)."""
    mosaic: Mosaic
    pictures: tuple[ClusterPicture, ...]
    track: NDArray[np.float64]
    """Where pictures were taken (m). Shape=(K, 2)."""

    @property
    def seen_m2(self) -> float:
        """Return the area of sea floor seen near enough to count (m²)."""
        return float(np.count_nonzero(self.seen)) * FINE_M**2


def measure(recording: Recording, cfg: ProductsCfg) -> SurveyProducts:
    """Measure everything.

    Raises:
        InputError: The recording has no keyframes, or one of them is broken.
    """
    recording = recording.located()
    track = np.array([keyframe.pose[:2] for keyframe in recording.keyframes()]).reshape(-1, 2)
    if not len(track):
        raise InputError(recording.source, "", "no picture with a pose", "at least one")
    cells = map_of(recording)
    cover, without = measure_cover(recording)
    cell_m = cells.cfg.cell_m
    # Beside the map's oysters only: a wrong mask that other pictures outvoted is no oyster.
    counted = fine_of(distance_to(cells.target, cell_m) <= BESIDE_M + 1e-6, cell_m, cover)
    share = 0.5 * (cover.seen + cover.filled) * counted
    in_cells = mean_in_cells(share, cover.known, cell_m, cells.target.shape)
    if cover.calibration is not None:
        cells.target &= np.nan_to_num(in_cells) >= CONFIRMED
    judgement, possible = judge(recording, cover, counted)
    group = label_clusters(cells, cfg.clusters, BESIDE_M)
    looks = count_looks(recording)
    area = area_within(cover, without, counted)
    wide = possible.widen(area, np.ones_like(counted))
    shells = count_shells(cover.seen * counted, cover.filled * counted, FINE_M, area.relative_error)
    return SurveyProducts(
        recording=recording,
        cfg=cfg,
        keyframes=len(track),
        cells=cells,
        area=wide if judgement.judged else replace(wide, low=0.0),
        judgement=judgement,
        shells=shells if judgement.judged else ShellCount(shells.singles),
        calibrated_reefs=0 if cover.calibration is None or not judgement.judged else cover.calibration.reefs,
        clusters=tuple(
            replace(one, area=possible.widen(one.area, fine_of(group == one.number, cell_m, cover)))
            for one in measure_clusters(cells, group, looks, cover, without, cfg.clusters)
        ),
        cover=in_cells,
        density=mean_in_cells(share, cover.known, DENSITY_CELL_M, grid_shape(recording, DENSITY_CELL_M)),
        seen=cover.known,
        looks=looks,
        mosaic=make_mosaic(recording, cfg.mosaic),
        pictures=tuple(best_pictures(recording, group)),
        track=track,
    )


def mean_in_cells(
    share: NDArray[np.float32], known: NDArray[np.bool_], cell_m: float, shape: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the mean of known fine cells in each larger cell, nan where too few are known. Shape=(NY, NX)."""
    iy, ix = larger_cells(share.shape, shape, cell_m)
    index = (iy[:, None] * shape[1] + ix[None, :])[known]
    size = shape[0] * shape[1]
    count = np.bincount(index, minlength=size).astype(np.float64)
    total = np.bincount(index, weights=share[known], minlength=size)
    enough = count * FINE_M**2 >= _LEAST_KNOWN * cell_m**2
    mean = np.where(enough, total / np.maximum(count, 1.0), np.nan)
    return mean.reshape(shape).astype(np.float32)
