"""Make docs/images/pool.png and sonar.png: the map of a pool after its survey, and what camera and sonar measure.

Run it from the repository: .venv/bin/python docs/figures/sonar.py (half a minute).
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import resolve_mission, with_sonar
from coral.reef.pictures.cameraview import camera_picture
from coral.reef.vehicle.camera import Camera
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.view.run import RunFolder
from coral.view.runmap import write_map

IMAGES = Path(__file__).parent.parent / "images"
WORLD = "pool:1"


def draw_pool() -> None:
    """Survey the pool and keep the map."""
    cfg, world = resolve_mission(with_sonar(MissionCfg(stop_when_covered=False)), find_world(WORLD), preset="pool")
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        Mission(world, cfg, RuleAdvisor(REEF_RULES), run, seed=1, preset="pool").run()
        shutil.copyfile(write_map(RunFolder.read(run)), IMAGES / "pool.png")


def draw_sonar() -> None:
    """Draw the camera's classes and the sonar's ranges from the same pose, as seen from the vehicle."""
    world = find_world(WORLD)
    scene, pose = Scene.from_world(world), Pose(world.start.x, world.start.y, world.start.theta)
    sonar = Sonar3d15(scene, SonarCfg(), np.random.default_rng(0), surface_z=world.water_depth_m)
    image = sonar.image(pose, 1.0)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.2), width_ratios=(1.0, 1.5), layout="constrained")
    left.imshow(camera_picture(Camera(scene).render(pose)))
    left.set_title("camera: oysters green, obstacles dark", fontsize=9)
    left.axis("off")
    ranges = np.where(np.isfinite(image.ranges), image.ranges, np.nan)
    shown = right.imshow(ranges[::-1], cmap="viridis_r", extent=(45, -45, -20, 20), vmin=0.0, vmax=4.0)
    right.set_title("sonar: range of the strongest echo; white: none", fontsize=9)
    right.set_xlabel("azimuth (°, left positive)", fontsize=8)
    right.set_ylabel("elevation (°)", fontsize=8)
    figure.colorbar(shown, ax=right, label="m", shrink=0.8)
    figure.savefig(IMAGES / "sonar.png", dpi=110)


if __name__ == "__main__":
    draw_pool()
    draw_sonar()
