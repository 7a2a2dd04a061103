"""Oysters mapped from colour pictures and poses alone, against the truth: a table of runs.

    python benchmarks/map_from_colour.py runs/s1 runs/l1 ...

Each run is a folder of `coral reef run REEF --cfg.simulator.pictures`. The network sees its colour pictures and nothing
else. Cells: of the map made from exact classes and depth, the share that the map from colour has too (recall), and of
the latter's the share that lies within one cell of the former's (precision). The network's votes count as they are,
without its calibration.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.map.chain import ChainCfg
from coral.reef.map.mapping import OccupancyMap, distance_to
from coral.reef.products.clusters import label_clusters
from coral.reef.products.cover import Area, CoverCfg, area_within, fine_of, measure_cover
from coral.reef.products.truth import true_area_m2
from coral.reef.recordings.perception import PicturePerception
from coral.reef.recordings.recording import Recording, map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.world.world import load_world

DOUBTS = (0.5, 0.3, 0.2, 0.1)
"""Limits of doubt for oysters."""


def main(folders: list[Path], say: Callable[[str], None] = print) -> None:
    """Print the table."""
    say("| reef | doubt up to | truth (m²) | survey (m²) | error | cells: recall | precision | clusters (exact map) |")
    say("|---|---|---|---|---|---|---|---|")
    for folder in folders:
        truth = true_area_m2(load_world(folder / "world.yaml"))
        exact = read_run(folder).located()
        there, area = mapped(exact)
        error = 100 * (area.m2 / truth - 1)
        say(f"| {exact.name} | exact classes | {truth:.2f} | {area.m2:.2f} | {error:+.1f} % | | | {clusters(there)} |")
        eyes = open_eyes("rgb")
        assert eyes is not None
        perception = PicturePerception(eyes, "rgb")
        for doubt in DOUBTS:
            seen = read_run(folder, perception).located()
            seen = replace(seen, map=replace(seen.map, doubt=replace(DoubtCfg(), oyster=doubt)))
            cells, area = mapped(seen)
            near = distance_to(there.target, there.cfg.cell_m) <= 1.01 * there.cfg.cell_m
            recall = np.count_nonzero(cells.target & there.target) / np.count_nonzero(there.target)
            precision = np.count_nonzero(cells.target & near) / max(np.count_nonzero(cells.target), 1)
            say(
                f"| {exact.name} | {doubt:g} | {truth:.2f} | {area.m2:.2f} | {100 * (area.m2 / truth - 1):+.0f} % | "
                f"{recall:.2f} | {precision:.2f} | {clusters(cells)} ({clusters(there)}) |"
            )


def mapped(recording: Recording) -> tuple[OccupancyMap, Area]:
    """Return the map of a located recording and its area of oysters, not calibrated."""
    cfg = CoverCfg(calibrated=False)
    cells = map_of(recording)
    cover, without = measure_cover(recording, cfg)
    near = distance_to(cells.target, cells.cfg.cell_m) <= cfg.beside_m + 1e-6
    return cells, area_within(cover, without, fine_of(near, cells.cfg.cell_m, cover))


def clusters(cells: OccupancyMap) -> int:
    """Return the number of clusters on a map."""
    return int(label_clusters(cells, ChainCfg(), 0.1).max())


if __name__ == "__main__":
    main([Path(word) for word in sys.argv[1:]])
