"""A reef described for Blender: the same solids, camera, light and water, as a job for `blender_script.py`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.floor_kernels import SAND
from coral.reef.paint.materials import Materials
from coral.reef.paint.solid_kernels import BLOCK, BUOY, PILE, ROCK, SHELL
from coral.reef.paint.water_kernels import ANISOTROPY
from coral.reef.simulation.daylight import PainterCfg, sun_direction
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import BOX, CYLINDER, ELLIPSOID, Scene
from coral.reef.world.water_types import FORWARD_SHARE, WaterType

_SHAPES = {ELLIPSOID: "ellipsoid", BOX: "box", CYLINDER: "cylinder"}
_MATERIALS = {SHELL: "shell", ROCK: "rock", PILE: "pile", BLOCK: "block", BUOY: "buoy"}
_TO_BLENDER = np.diag([1.0, -1.0, -1.0, 1.0])
"""Blender's cameras look along -z with y up; ours along z with y down."""


@dataclass(frozen=True, kw_only=True)
class CyclesCfg:
    """How long Cycles works on a picture."""

    samples: int = 24
    """Paths a pixel."""
    denoise: bool = True
    """Remove the noise of few samples with Open Image Denoise."""
    threads: int = 1


def describe_scene(
    scene: Scene, camera: CameraCfg, water: WaterType, cfg: PainterCfg, cycles: CyclesCfg, *, seed: int
) -> dict[str, Any]:
    """Describe everything but the views; plain numbers and text, in metres, radians and the world's frame.

    Args:
        scene: Solids and sea floor.
        camera: Size and lens.
        water: Coefficients of the volume.
        cfg: Depth of the water and the sun.
        cycles: Samples.
        seed: Of the colours, as for `Painter`.
    """
    materials = Materials.of(scene, seed)
    middle = scene.center[:, :2].mean(axis=0).tolist() if len(scene) else [0.0, 0.0]
    side = 1.0 - FORWARD_SHARE
    return {
        "seed": seed,
        "samples": cycles.samples,
        "denoise": cycles.denoise,
        "threads": cycles.threads,
        "camera": {
            "width": camera.width,
            "height": camera.height,
            "hfov_deg": camera.hfov_deg,
            "near_m": camera.near_m,
        },
        "sun": {
            "direction": list(sun_direction(cfg)),
            "energy": (1.0 - cfg.sky_share),
            "sky_energy": cfg.sky_share,
        },
        "water": {
            "name": water.name,
            "depth_m": cfg.water_depth_m,
            "middle": middle,
            "absorption": list(water.absorption),
            "scattering": [side * b for b in water.scattering],
            "diffuse": list(water.diffuse),
            "anisotropy": ANISOTROPY,
        },
        "floor": {"z_m": scene.seabed_z, "middle": middle, "sand": list(SAND)},
        "solids": [
            {
                "shape": _SHAPES[int(scene.kind[i])],
                "material": _MATERIALS[int(materials.kind[i])],
                "center": scene.center[i].tolist(),
                "half": scene.half[i].tolist(),
                "rotation": scene.rotation[i].tolist(),
                "paint": materials.paint[i].tolist(),
            }
            for i in range(len(scene))
        ],
        "caustics": None,
        "blend": "",
        "folder": "",
        "views": [],
    }


def describe_view(name: str, pose: Pose, camera: CameraCfg, scene: Scene, seed: int) -> dict[str, Any]:
    """Describe one view: its name and where Blender's camera stands.

    Args:
        name: Of the file that is written.
        pose: Of the body.
        camera: Height and tilt.
        scene: Height of the sea floor.
        seed: Of the samples.
    """
    transform: NDArray[np.float64] = T_world_camera(pose, camera, seabed_z=scene.seabed_z) @ _TO_BLENDER
    return {"name": name, "T_world_camera": transform.tolist(), "seed": seed}


def solid_of_index(index: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Convert Blender's object indices to numbers of solids, -1 elsewhere, and to where the sea floor is."""
    return np.where(index >= 2, index - 2, -1).astype(np.int32), index == 1
