"""`coral reef picture`: what the robot's camera would take, in one water or several."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from coral.errors import InputError
from coral.file_writer import write_whole, writing
from coral.flags import Argument, Option
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.world.world_names import shipped_worlds


@dataclass(frozen=True, kw_only=True)
class ReefPicture:
    """Take one colour picture of a reef, with its camera and pose beside it; with several waters, a contact sheet."""

    world: Annotated[str, Argument(names=shipped_worlds)]
    """Name of a reef or a world file."""
    out: Path
    """The PNG file to write. Camera and pose go into camera.yaml and poses.csv of its folder, which `coral reef map`
    reads; pictures that are taken into the same folder later are added."""
    water: tuple[str, ...] = ("clear",)
    """Jerlov types (jerlov-3C) or presets (clear, coast, bay, hard); all: every Jerlov type."""
    at: Annotated[tuple[float, float, float] | None, Option(metavar="X Y HEADING")] = None
    """Place of the robot (m) and heading (degrees, counter-clockwise from +x); a place near oysters by default."""
    size: tuple[int, int] = (640, 480)
    """Width and height of a picture (px)."""
    t: float = 0.0
    """Time (s): waves, snow and animals move."""
    seed: Annotated[int, Option(metavar="N")] = 0
    """Of the place, where --at names none."""
    painter: PainterCfg = field(default_factory=PainterCfg)
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.config import checked
        from coral.drawing import contact_sheet
        from coral.reef.paint.painter import Painter
        from coral.reef.paint.viewpoints import choose_viewpoints
        from coral.reef.pictures.mapview import png
        from coral.reef.recordings.picture_folder import add_picture, table_of
        from coral.reef.vehicle.camera import Camera, CameraCfg
        from coral.reef.world.find_world import find_world
        from coral.reef.world.geometry import Pose
        from coral.reef.world.scene import Scene
        from coral.reef.world.water_types import JERLOV, find_water

        world, cfg = find_world(self.world), checked(self.painter, "--painter")
        names = list(JERLOV) if self.water == ("all",) else list(self.water)
        waters = [find_water(name, "--water") for name in names]
        if not waters:
            raise InputError("--water", "", "nothing", "at least one water")
        if self.out.suffix.lower() != ".png":
            raise InputError("--out", "", str(self.out), "a file name that ends in .png")
        if self.out.exists():
            raise InputError("--out", "", f"{self.out} exists", "a new file")
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        if not all(map(math.isfinite, (self.t, *(self.at or ())))) or self.t < 0.0:
            raise InputError("--at or --t", "", "no finite number", "metres, degrees and seconds")
        camera = CameraCfg(width=self.size[0], height=self.size[1])
        scene = Scene.from_world(world)
        if self.at is None:
            (pose,) = choose_viewpoints(scene, 1, np.random.default_rng(self.seed))
        else:
            pose = Pose(self.at[0], self.at[1], math.radians(self.at[2]))
        table = table_of(self.out.parent, camera) if len(waters) == 1 else []
        frame = Camera(scene, camera).render(pose, t=self.t)
        taken = [
            (f"{water.name}, visibility {water.visibility_m:.1f} m",
             Painter(scene, camera, water, cfg, world.seed).paint(frame, pose, t=self.t))
            for water in waters
        ]  # fmt: skip
        picture = taken[0][1] if len(taken) == 1 else contact_sheet(taken, columns=2 if len(taken) <= 4 else 5)
        with writing("--out", str(self.out)):
            write_whole(self.out, png(picture))
            if table:
                add_picture(self.out.parent, table, camera, self.out.name, pose, self.t)
        return {
            "picture": str(self.out),
            "waters": {water.name: round(water.visibility_m, 2) for water in waters},
            "at": [round(pose.x, 3), round(pose.y, 3), round(math.degrees(pose.theta), 1)],
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        x, y, heading = result["at"]
        seen = ", ".join(f"{name} (visibility {v:g} m)" for name, v in result["waters"].items())
        return f"{result['picture']}: from ({x:g}, {y:g}) m, heading {heading:g}°, in {seen}"
