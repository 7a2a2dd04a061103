"""CPU time of one colour picture under water, part by part of the work, beside the ray cast that it starts from.

Usage: python benchmarks/pictures.py [--poses 40] [--json]
"""

from __future__ import annotations

import argparse
import json
import time

import numpy as np

from coral.reef.paint.painter import Painter
from coral.reef.paint.viewpoints import choose_viewpoints
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world


def measure(work: object, frames: list, poses: list) -> list[float]:
    """Return the CPU time of each picture (ms)."""
    times = []
    for k, (frame, pose) in enumerate(zip(frames, poses, strict=True)):
        start = time.process_time()
        work(frame, pose, k)
        times.append(1e3 * (time.process_time() - start))
    return times


def main() -> None:
    """Print median and 95th percentile by size and water."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=40)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    scene = Scene.from_world(load_world("s1"))
    poses = choose_viewpoints(scene, args.poses, np.random.default_rng(0))
    rows = []
    for width, height in ((160, 120), (320, 240), (640, 480)):
        cfg = CameraCfg(width=width, height=height)
        camera = Camera(scene, cfg)
        frames = [camera.render(pose) for pose in poses]
        cast = measure(lambda _, pose, k, camera=camera: camera.render(pose), frames, poses)
        for water in ("clear", "bay"):
            painter = Painter(scene, cfg, water, seed=1)
            painter.paint(frames[0], poses[0], velocity=(0.5, 0.0, 0.2))
            took = measure(
                lambda frame, pose, k, painter=painter: painter.paint(frame, pose, t=0.1 * k, velocity=(0.5, 0.0, 0.2)),
                frames,
                poses,
            )
            rows.append(
                {
                    "size": f"{width}x{height}",
                    "water": water,
                    "picture_ms": round(float(np.median(took)), 2),
                    "picture_p95_ms": round(float(np.percentile(took, 95)), 2),
                    "ray_cast_ms": round(float(np.median(cast)), 2),
                }
            )
    if args.json:
        print(json.dumps(rows))
        return
    print("| size | water | picture ms | 95 % | ray cast ms |\n|---|---|---:|---:|---:|")
    for row in rows:
        print("| {size} | {water} | {picture_ms} | {picture_p95_ms} | {ray_cast_ms} |".format(**row))


if __name__ == "__main__":
    main()
