"""Areas of oysters by a network, each reef with a calibration that was made without it: a table of runs.

    python benchmarks/calibrated_areas.py runs/l9001 runs/s9001 ...

The runs are those of `coral reef eyes calibrate`. Intervals are those of the products.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from coral.reef.eyes.backends import open_eyes
from coral.reef.map.mapping import distance_to
from coral.reef.products.calibrate_cover import calibrate, gather_evidence
from coral.reef.products.cover import CoverCfg, area_within, collect_votes, fine_of, make_covers
from coral.reef.recordings.perception import PicturePerception
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.world.world import load_world


def main(folders: list[Path]) -> None:
    """Print the table."""
    eyes, cfg = open_eyes("rgb"), CoverCfg()
    assert eyes is not None
    recordings = [read_run(folder, PicturePerception(eyes, "rgb")).located() for folder in folders]
    reefs = [
        gather_evidence(one, load_world(f / "world.yaml"), cfg) for one, f in zip(recordings, folders, strict=True)
    ]
    print("| reef | truth (m²) | survey (m²) | interval (m²) | error | truth inside |\n|---|---|---|---|---|---|")
    errors, inside = [], 0
    for number, (recording, reef) in enumerate(zip(recordings, reefs, strict=True)):
        calibration = calibrate(reefs[:number] + reefs[number + 1 :], "left out")
        cells = map_of(recording)
        cover, without = make_covers(collect_votes(recording, cfg, soft=True), cfg, calibration)
        near = distance_to(cells.target, cells.cfg.cell_m) <= cfg.beside_m + 1e-6
        area = area_within(cover, without, fine_of(near, cells.cfg.cell_m, cover))
        truth = reef.whole.true_m2
        covered = area.low_m2 <= truth <= area.high_m2
        errors.append(area.m2 / truth - 1.0)
        inside += covered
        print(
            f"| {reef.name} | {truth:.2f} | {area.m2:.2f} | {area.low_m2:.2f} to {area.high_m2:.2f} | "
            f"{100 * errors[-1]:+.1f} % | {'yes' if covered else 'no'} |",
            flush=True,
        )
    rms = 100 * float(np.sqrt(np.mean(np.square(errors))))
    print(f"\n{inside} of {len(reefs)} intervals contain the truth; root mean square of the errors {rms:.1f} %.")


if __name__ == "__main__":
    main([Path(word) for word in sys.argv[1:]])
