"""Area of oysters by surveys of simulated reefs, against the truth: a table of runs.

    python benchmarks/reef_area.py [--uncalibrated] runs/l1-own runs/s1-own ...

Each run is a folder of `coral reef run REEF --cfg.no-stop-when-covered`, the robot's own end. What a network saw
(--perception rgb) is calibrated, unless --uncalibrated is given.
"""

from __future__ import annotations

import sys
from pathlib import Path

from coral.reef.map.mapping import distance_to
from coral.reef.products.cover import CoverCfg, area_within, fine_of, measure_cover
from coral.reef.products.truth import true_area_m2
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.world.world import load_world


def main(folders: list[Path], cfg: CoverCfg) -> None:
    """Print the table."""
    print("| reef | truth (m²) | survey (m²) | interval (m²) | error | truth inside | cells of the map, counted (m²) |")
    print("|---|---|---|---|---|---|---|")
    errors, inside = [], 0
    for folder in folders:
        recording = read_run(folder).located()
        cells = map_of(recording)
        cover, without = measure_cover(recording, cfg)
        near = distance_to(cells.target, cells.cfg.cell_m) <= cfg.beside_m + 1e-6
        area = area_within(cover, without, fine_of(near, cells.cfg.cell_m, cover))
        truth = true_area_m2(load_world(folder / "world.yaml"))
        error, covered = area.m2 / truth - 1.0, area.low_m2 <= truth <= area.high_m2
        errors.append(error)
        inside += covered
        counted = float(cells.target.sum()) * cells.cfg.cell_m**2
        print(
            f"| {recording.name} | {truth:.2f} | {area.m2:.2f} | {area.low_m2:.2f} to {area.high_m2:.2f} | "
            f"{100 * error:+.1f} % | {'yes' if covered else 'no'} | "
            f"{counted:.2f} ({100 * (counted / truth - 1):+.0f} %) |",
            flush=True,
        )
    worst = max(errors, key=abs)
    print(f"\n{inside} of {len(folders)} intervals contain the truth; the largest error is {100 * worst:+.1f} %.")


if __name__ == "__main__":
    words = sys.argv[1:]
    calibrated = "--uncalibrated" not in words
    main([Path(word) for word in words if word != "--uncalibrated"], CoverCfg(calibrated=calibrated))
