"""`coral reef blender`: a reef as a .blend file, and photorealistic pictures of it."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from coral.config import Count
from coral.errors import InputError
from coral.flags import Argument, Option
from coral.reef.world.world_names import shipped_worlds


@dataclass(frozen=True, kw_only=True)
class ReefBlender:
    """Build a reef in Blender and render pictures with Cycles. Needs the extra `blender`."""

    world: Annotated[str, Argument(names=shipped_worlds)]
    """Name of a reef or a world file."""
    out: Path
    """The .blend file to write. Pictures go into a folder of the same name without .blend."""
    render: Annotated[int, Option(metavar="N")] = 0
    """Number of pictures, from random places near oysters, with depth and classes."""
    water: str = "clear"
    """Water: a Jerlov type (jerlov-3C) or a preset's name."""
    size: tuple[int, int] = (320, 240)
    """Width and height of the pictures (px)."""
    samples: Count = 24
    """Paths that Cycles follows for each pixel."""
    seed: Annotated[int, Option(metavar="N")] = 0
    """Of the places."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Describe the reef, run Blender, and write what it returns."""
        from coral.reef.paint.blender import find_python, render_views
        from coral.reef.paint.blender_scene import CyclesCfg, describe_scene, describe_view
        from coral.reef.paint.picture_set import TakenPicture, write_picture
        from coral.reef.paint.viewpoints import choose_viewpoints
        from coral.reef.simulation.daylight import PainterCfg
        from coral.reef.vehicle.camera import CameraCfg
        from coral.reef.world.generated import find_world
        from coral.reef.world.scene import Scene
        from coral.reef.world.water_types import find_water

        world, water = find_world(self.world), find_water(self.water, "--water")
        if self.out.suffix != ".blend":
            raise InputError("--out", "", str(self.out), "a file name that ends in .blend")
        folder = self.out.with_suffix("")
        for path in (self.out, folder / "pictures.csv"):
            if path.exists():
                raise InputError("--out", "", f"{path} exists", "a new file")
        if self.render < 0 or self.seed < 0:
            raise InputError("--render" if self.render < 0 else "--seed", "", "a negative number", "a number from 0 on")
        find_python()
        camera = CameraCfg(width=self.size[0], height=self.size[1])
        scene, cfg = Scene.from_world(world), PainterCfg()
        job = describe_scene(scene, camera, water, cfg, CyclesCfg(samples=self.samples), seed=world.seed)
        poses = choose_viewpoints(scene, self.render, np.random.default_rng(self.seed))
        job["views"] = [describe_view(f"{k:04d}", pose, camera, scene, self.seed + k) for k, pose in enumerate(poses)]
        self.out.parent.mkdir(parents=True, exist_ok=True)
        job["blend"] = str(self.out.resolve())
        begun, seen = time.monotonic(), replace(camera)

        def tell(name: str) -> None:
            print(f"rendered {int(name) + 1} of {len(poses)}, {time.monotonic() - begun:.0f} s", file=sys.stderr)

        for (name, frame), pose in zip(render_views(job, scene, camera, cfg, told=tell), poses, strict=True):
            about = TakenPicture(
                name=name,
                world=world.name,
                water=water.name,
                pose=pose,
                height=seen.altitude_m,
                pitch_down_deg=seen.pitch_down_deg,
                hfov_deg=seen.hfov_deg,
                range_m=seen.range_m,
            )
            write_picture(folder, about, frame)
        return {
            "blend": str(self.out),
            "pictures": len(poses),
            "folder": str(folder) if poses else None,
            "water": water.name,
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return what was written."""
        lines = [f"scene: {result['blend']}"]
        if result["folder"]:
            lines.append(
                f"{result['pictures']} pictures with depth and classes in {result['water']}: {result['folder']}"
            )
        return "\n".join(lines)
