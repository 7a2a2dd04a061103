"""Time of the map update and of the centroid chain, and how it grows with the map and with the oysters on it.

Usage: python benchmarks/mapping.py [--poses 60] [--json]

A reef of the given size is seen from a lawnmower of poses until the whole map is full; then each part is timed over
poses spread over it, and the medians are printed: CPU time, which leaves out what else the machine does. In a mission
the map is updated at every tick, the chain at every fifth, its centroids only when an oyster cell has changed, and the
distances only when an obstacle cell has.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import time
from collections.abc import Callable

import numpy as np

from coral.reef.map.chain import CentroidTracker, ChainCfg, components
from coral.reef.map.mapping import OccupancyMap, distance_to
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

CASES = {
    "map": [(10.0, 500), (20.0, 500), (40.0, 500), (80.0, 500)],
    "oysters": [(30.0, 100), (30.0, 400), (30.0, 1600), (30.0, 6400)],
}
"""(edge of the square map in metres, oysters) of each case."""
BED = 40
"""Oysters in each cluster."""
OBSTACLES_M2 = 0.06
"""For each square metre, as in the shipped reefs."""


def reef(edge_m: float, oysters: int, rng: np.random.Generator) -> ReefWorld:
    """Beds of oysters on a grid, obstacles between them, the start in a corner that is kept clear."""
    beds = max(1, oysters // BED)
    columns = math.ceil(math.sqrt(beds))
    spots = [
        (edge_m * (i + 0.5) / columns, edge_m * (j + 0.5) / columns)
        for j, i in itertools.product(range(columns), repeat=2)
    ][:beds]
    size = min(0.5, 0.15 * edge_m / columns)
    clusters = []
    for k, (x, y) in enumerate(spots):
        places = np.clip(rng.normal((x, y), size, (oysters // beds, 2)), 0.1, edge_m - 0.1)
        clusters.append(
            Cluster(
                name=f"c{k}",
                oysters=tuple(
                    Oyster(x=float(a), y=float(b), z=0.04, radii=(0.1, 0.07, 0.05), rpy=(0.0, 0.0, float(yaw)))
                    for (a, b), yaw in zip(places, rng.uniform(-3, 3, len(places)), strict=True)
                ),
            )
        )
    rocks = []
    while len(rocks) < min(500, round(OBSTACLES_M2 * edge_m**2)):
        x, y = rng.uniform(0.5, edge_m - 0.5, 2)
        if math.hypot(x - 2.0, y - 2.0) > 2.0:
            rocks.append(Obstacle(shape="cylinder", x=float(x), y=float(y), z=0.5, size=(0.2, 0.2, 0.5)))
    return ReefWorld(
        name="benchmark",
        size_m=(edge_m, edge_m),
        start=Start(x=2.0, y=2.0, theta=0.7),
        clusters=tuple(clusters),
        obstacles=tuple(rocks),
    )


def median_ms(call: Callable[[Pose], object], poses: list[Pose]) -> float:
    """Median time of a call over poses (ms)."""
    times = []
    for pose in poses:
        begun = time.process_time()
        call(pose)
        times.append(1e3 * (time.process_time() - begun))
    return float(np.median(times))


def measure(edge_m: float, oysters: int, n_poses: int) -> dict[str, float]:
    """One line of a table."""
    rng = np.random.default_rng(3)
    world = reef(edge_m, oysters, rng)
    camera, chain = CameraCfg(), ChainCfg()
    eye, cells = Camera(Scene.from_world(world), camera), OccupancyMap(world.size_m, camera)
    lanes = np.arange(1.0, edge_m, 3.0)
    for x, y, theta in itertools.product(lanes, lanes, (0.0, math.pi)):
        pose = Pose(float(x), float(y), theta)
        cells.integrate(eye.render(pose), pose)
    poses = [Pose(*map(float, rng.uniform(1.0, edge_m - 1.0, 2)), float(rng.uniform(-3, 3))) for _ in range(n_poses)]
    frames = {pose: eye.render(pose) for pose in poses}
    tracker, cell_m = CentroidTracker(chain), cells.cfg.cell_m
    tracker.update(components(cells.target, cell_m, chain))
    return {
        "edge_m": edge_m, "oysters": sum(len(c.oysters) for c in world.clusters), "cells": cells.target.size,
        "centroids": len(tracker.tracks),
        "picture_ms": median_ms(lambda pose: eye.render(pose), poses),
        "update_ms": median_ms(lambda pose: cells.integrate(frames[pose], pose), poses),
        "centroids_ms": median_ms(lambda pose: components(cells.target, cell_m, chain), poses),
        "chain_ms": median_ms(lambda pose: (tracker.update(components(cells.target, cell_m, chain)), tracker.chain()),
                              poses),
        "distances_ms": median_ms(lambda pose: distance_to(cells.obstacle, cell_m), poses[:20]),
        "near_ms": median_ms(lambda pose: (cells.distance_near(pose.x + 2.0, pose.y, 5.0),
                                           cells.distance_near(pose.x, pose.y, 5.0)), poses) / 2,
    }  # fmt: skip


COLUMNS = {
    "edge_m": "map, m",
    "cells": "cells",
    "oysters": "oysters",
    "centroids": "clusters found",
    "picture_ms": "picture",
    "update_ms": "map update",
    "centroids_ms": "centroids",
    "chain_ms": "with chain",
    "distances_ms": "distances, whole map",
    "near_ms": "distances, near",
}


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=60, help="timed calls in each case")
    parser.add_argument("--largest", type=float, default=math.inf, help="leave out larger maps (m)")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    measure(6.0, 40, 2)  # compiles
    rows = {
        name: [measure(edge, oysters, args.poses) for edge, oysters in cases if edge <= args.largest]
        for name, cases in CASES.items()
    }
    if args.json:
        print(json.dumps(rows))
        return
    for name, lines in rows.items():
        print(f"Growth with the {name}; medians in ms\n\n| {' | '.join(COLUMNS.values())} |")
        print(f"|{'---:|' * len(COLUMNS)}")
        for line in lines:
            print(
                "| "
                + " | ".join(
                    f"{line[key]:.3f}"
                    if key.endswith("_ms")
                    else f"{line[key]:g}"
                    if key == "edge_m"
                    else f"{line[key]:,}".replace(",", " ")
                    for key in COLUMNS
                )
                + " |"
            )
        print()


if __name__ == "__main__":
    main()
