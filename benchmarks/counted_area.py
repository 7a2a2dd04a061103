"""How well a reef's oyster area is told by counting its clusters alone: the least that a survey must beat.

    python benchmarks/counted_area.py l1 l2 s1 ... sparse1.yaml

Each cluster counts as the mean of a cluster in the 15 reefs of the shipped calibration. Nothing is looked at.
"""

from __future__ import annotations

import sys

import numpy as np

from coral.reef.products.truth import true_area_m2
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.world import load_world

CALIBRATION_SEEDS = (9001, 9101, 9102)


def main(reefs: list[str]) -> None:
    """Print the table."""
    known = [generate(GeneratorCfg(topology=kind, seed=seed), kind) for seed in CALIBRATION_SEEDS for kind in "LSKEO"]
    each_m2 = sum(true_area_m2(world) for world in known) / sum(len(world.clusters) for world in known)
    print(
        f"{each_m2:.4f} m² a cluster\n\n| reef | clusters | truth (m²) | counted (m²) | error |\n|---|---|---|---|---|"
    )
    errors = []
    for reef in reefs:
        world = load_world(reef)
        truth, counted = true_area_m2(world), each_m2 * len(world.clusters)
        errors.append(100 * (counted / truth - 1))
        print(f"| {world.name} | {len(world.clusters)} | {truth:.2f} | {counted:.2f} | {errors[-1]:+.1f} % |")
    worst = max(errors, key=abs)
    print(f"\nLargest error {worst:+.1f} %, root mean square {np.sqrt(np.mean(np.square(errors))):.1f} %.")


if __name__ == "__main__":
    main(sys.argv[1:])
