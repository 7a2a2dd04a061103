"""Runs Blender: writes a reef as a .blend file and renders pictures of it with Cycles."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coral.errors import InputError, RunError
from coral.file_writer import write_whole
from coral.foreign_file import parse_json, read_arrays
from coral.reef.paint import caustics
from coral.reef.paint.blender_scene import solid_of_index
from coral.reef.paint.exposure import expose
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label
from coral.reef.world.scene import Scene

SCRIPT = Path(__file__).with_name("blender_script.py")
VARIABLE = "CORAL_BLENDER_PYTHON"
"""Environment variable: a Python that has bpy, if this one has not."""


def blender_python() -> str | None:
    """Return the Python interpreter that should have bpy: that of `VARIABLE`, this one, that of `make setup-blender`.

    None: there is none. bpy wants an older NumPy than this package, so it usually has an environment of its own.
    """
    named = os.environ.get(VARIABLE)
    if named:
        return named
    if importlib.util.find_spec("bpy") is not None:
        return sys.executable
    beside = Path(sys.prefix) / "share" / "coral-blender" / "bin" / "python"
    return str(beside) if beside.exists() else None


def find_python() -> str:
    """Return the interpreter of `blender_python`.

    Raises:
        InputError: There is none, or it cannot be run.
    """
    found = blender_python()
    if found is None:
        raise InputError(
            "blender", "", "no bpy", f"`make setup-blender`, or {VARIABLE}=PYTHON of an environment with bpy 5.0"
        )
    if not os.access(found, os.X_OK):
        raise InputError(VARIABLE, "", repr(found), "the Python of an environment with bpy")
    return found


def render_views(
    job: Mapping[str, Any],
    scene: Scene,
    camera: CameraCfg,
    cfg: PainterCfg,
    *,
    t: float = 0.0,
    told: Callable[[str], None] = lambda name: None,
) -> Iterator[tuple[str, Frame]]:
    """Carry out a job: save the .blend file if it names one, render its views, and develop them as our camera does.

    Args:
        job: As `describe_scene` makes it, with its views.
        scene: The solids, for the classes.
        camera: Range beyond which surfaces are not seen.
        cfg: Lens and sensor.
        t: Time of the caustics (s).
        told: Called with the name of every view that is done.

    Yields:
        Name and frame of every view, in the job's order.

    Raises:
        RunError: Blender failed.
    """
    python = find_python()
    with tempfile.TemporaryDirectory(prefix="coral-blender-") as name:
        folder = Path(name)
        whole = dict(job, folder=name)
        if cfg.wave_slope > 0.0:
            film = caustics.caustics(0, cfg.water_depth_m, cfg.wave_slope)
            pattern = film[int(t % caustics.PERIOD_S / caustics.PERIOD_S * len(film))]
            # A slide can only dim: all light is brightened by as much as the brightest spots need.
            most = float(np.quantile(pattern, 0.999))
            np.save(folder / "caustics.npy", pattern)
            path = str(folder / "caustics.npy")
            whole["caustics"] = {
                "path": path, "most": most, "tile_m": caustics.TILE_M, "middle": job["floor"]["middle"],
            }  # fmt: skip
            sun = job["sun"]
            whole["sun"] = {**sun, "energy": most * sun["energy"], "sky_energy": most * sun["sky_energy"]}
        write_whole(folder / "job.json", json.dumps(whole))
        _run(python, folder / "job.json", told)
        for view in job["views"]:
            yield view["name"], _develop(folder / f"{view['name']}.npz", scene, camera, cfg, view["seed"])


def _run(python: str, job: Path, told: Callable[[str], None]) -> None:
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [python, "-W", "ignore", str(SCRIPT), str(job)]
    last: list[str] = []
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, errors="replace"
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith('{"rendered"'):
                told(parse_json(line)["rendered"])
            elif line.strip():
                last = [*last[-4:], line.strip()]
    if process.returncode != 0:
        raise RunError(f"Blender failed (exit code {process.returncode}): {' | '.join(last)}")


def _develop(path: Path, scene: Scene, camera: CameraCfg, cfg: PainterCfg, seed: int) -> Frame:
    """Turn what Blender measured into a frame, with the limits of our camera."""
    found = read_arrays(path)
    light, depth, index = found["light"], found["depth"].astype(np.float32), found["index"]
    instances, floor = solid_of_index(index)
    fx, fy, cx, cy = camera.intrinsics
    p, q = (np.arange(camera.width) - cx) / fx, (np.arange(camera.height) - cy) / fy
    far = depth * np.sqrt(1.0 + p[None, :] ** 2 + q[:, None] ** 2) > camera.range_m
    nothing = far | ((instances < 0) & ~floor)
    labels = np.where(floor, np.uint8(Label.SEABED), np.uint8(Label.WATER))
    if len(scene):
        labels = np.where(instances >= 0, scene.label[np.maximum(instances, 0)], labels)
    rgb = expose(np.ascontiguousarray(light, np.float32), cfg, seed)
    return Frame(
        np.where(nothing, np.float32(np.inf), depth).astype(np.float32),
        np.where(nothing, np.uint8(Label.WATER), labels).astype(np.uint8),
        np.where(nothing, -1, instances).astype(np.int32),
        rgb,
    )
