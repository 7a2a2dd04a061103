"""What limits of doubt do to the map: oysters of eyes against exact perception, along the same legs.

    python benchmarks/eyes_doubt.py [REEF/WATER ...] [--perception FILE.onnx]

The camera moves in parallel legs over reefs on which nothing is trained. Cells of all reefs are counted together.
A false cell is more than 0.3 m from any cell in which exact perception sees an oyster. IoU is that of oyster cells.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.map.mapping import MapCfg, OccupancyMap, distance_to
from coral.reef.paint.painter import Painter
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.collision import clearance
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water

LEGS_M, APART_M = 4.0, 0.2
"""Distance between legs, and between pictures."""
FREE_M = 0.35
"""Least distance from the camera to an obstacle."""
FALSE_M, FAR_M = 0.3, 1.0
CLUSTER_CELLS = 100
"""Smallest cluster, as in the paper."""
OYSTERS = (0.05, 0.1, 0.2, 0.3, 0.5)


@dataclass(frozen=True)
class Swept:
    """A reef as eyes saw it, and as it is."""

    size_m: tuple[float, float]
    seen: list[tuple[Pose, Frame]]
    exact: OccupancyMap
    to_oyster: NDArray[np.float32]
    """Distance of each cell to the nearest in which an oyster ever showed (m)."""


def legs(scene: Scene, size_m: tuple[float, float]) -> Iterator[Pose]:
    """Yield poses along parallel legs, there and back, without those too close to an obstacle."""
    hiders = scene.footprints()
    for k, y in enumerate(np.arange(2.0, size_m[1] - 1.0, LEGS_M)):
        along = np.arange(1.0, size_m[0] - 1.0, APART_M)
        for x in along[::-1] if k % 2 else along:
            if clearance(hiders, float(x), float(y)) > FREE_M:
                yield Pose(float(x), float(y), math.pi if k % 2 else 0.0)


def sweep(name: str, water: str, eyes: RgbPerception, camera: CameraCfg) -> Swept:
    """Take pictures of a reef and let eyes see them."""
    world = find_world(name)
    scene = Scene.from_world(world)
    caster, painter = Camera(scene, camera), Painter(scene, camera, find_water(water, "water"), seed=world.seed)
    exact, seen = OccupancyMap(world.size_m, camera), []
    for k, pose in enumerate(legs(scene, world.size_m)):
        frame = caster.render(pose)
        exact.integrate(frame, pose)
        rgb = painter.paint(frame, pose, t=k * APART_M / 0.5, velocity=(0.5, 0.0, 0.0))
        seen.append((pose, replace(perceive_frame(replace(frame, rgb=rgb), eyes, camera, CameraAttitude()), rgb=None)))
    # One pixel is enough for a cell not to be false.
    return Swept(world.size_m, seen, exact, distance_to(exact._targets > 0, exact.cfg.cell_m))


def count(reefs: list[Swept], doubt: DoubtCfg, camera: CameraCfg) -> NDArray[np.float64]:
    """Count oyster cells (both, of the map, exact, false) and false clusters."""
    total = np.zeros(5)
    for reef in reefs:
        cells = OccupancyMap(reef.size_m, camera, MapCfg(doubt=doubt))
        for pose, frame in reef.seen:
            cells.integrate(frame, pose)
        number, blobs, stats, _ = cv2.connectedComponentsWithStats(cells.target.astype(np.uint8), connectivity=8)
        large = [k for k in range(1, number) if stats[k, cv2.CC_STAT_AREA] >= CLUSTER_CELLS]
        far = sum(bool(reef.to_oyster[blobs == k].min() > FAR_M) for k in large)
        true = reef.exact
        total += (
            np.count_nonzero(cells.target & true.target),
            np.count_nonzero(cells.target),
            np.count_nonzero(true.target),
            np.count_nonzero(cells.target & (reef.to_oyster > FALSE_M)),
            far,
        )
    return total


def main() -> None:
    """Print a table of limits of oysters."""
    parser = argparse.ArgumentParser()
    parser.add_argument("reefs", nargs="*", default=["gen:20/clear", "gen:21/1C", "gen:22/bay"], help="REEF/WATER")
    parser.add_argument("--perception", default="painted")
    asked = parser.parse_args()
    eyes, camera = open_eyes(asked.perception), CameraCfg()
    assert eyes is not None, "exact perception has no doubt"
    reefs = [sweep(*text.rsplit("/", 1), eyes, camera) for text in asked.reefs]
    print(f"{sum(len(reef.seen) for reef in reefs)} pictures of {', '.join(asked.reefs)}\n")
    print("| largest doubt of oysters | IoU of cells | precision | recall | false cells | false clusters |")
    print("|---|---|---|---|---|---|")
    for limit in OYSTERS:
        both, mine, true, false, far = count(reefs, DoubtCfg(oyster=limit), camera)
        iou, precision, recall = both / (mine + true - both), both / max(mine, 1.0), both / true
        print(f"| {limit} | {iou:.3f} | {precision:.2f} | {recall:.2f} | {false:.0f} | {far:.0f} |", flush=True)


if __name__ == "__main__":
    main()
