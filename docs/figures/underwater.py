"""The pictures of docs/reference/underwater-pictures.md. The second needs folders that `coral reef blender` rendered.

Usage: python docs/figures/underwater.py [FOLDER ...]
"""

from __future__ import annotations

import subprocess
import sys
from itertools import chain
from pathlib import Path

import cv2
import numpy as np

from coral.reef.paint.painter import Painter
from coral.reef.paint.picture_set import read_pictures
from coral.reef.pictures.mapview import png
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.generated import find_world
from coral.reef.world.scene import Scene

IMAGES = Path(__file__).parents[1] / "images"


def draw_waters() -> None:
    """Write the contact sheet of waters, with the command of the page."""
    out = IMAGES / "underwater-waters.png"
    out.unlink(missing_ok=True)
    waters = ["clear", "jerlov-1C", "bay", "hard"]
    command = ["reef", "picture", "s1", "--at", "6", "5.3", "0", "--size", "320", "240", "--water", *waters]
    subprocess.run([sys.executable, "-m", "coral", *command, "--out", str(out)], check=True)


def draw_cycles(folders: list[Path]) -> None:
    """Write one picture of each folder above the same view of ours."""
    upper, lower = [], []
    for folder in folders:
        about, seen = next(chain(read_pictures(folder)))
        world = find_world(about.world)
        scene = Scene.from_world(world)
        height, width = seen.depth.shape
        camera = CameraCfg(width=width, height=height)
        ours = Painter(scene, camera, about.water, seed=world.seed).paint(
            Camera(scene, camera).render(about.pose), about.pose
        )
        for row, picture in ((upper, seen.rgb), (lower, ours)):
            row.append(cv2.resize(picture, (240, 180), interpolation=cv2.INTER_CUBIC))
    (IMAGES / "underwater-cycles.png").write_bytes(png(np.vstack([np.hstack(upper), np.hstack(lower)])))


if __name__ == "__main__":
    draw_waters()
    if sys.argv[1:]:
        draw_cycles([Path(name) for name in sys.argv[1:]])
