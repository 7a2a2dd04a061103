"""The scene of a recorded episode at any moment, drawn by ray casting without OpenGL."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at
from coral.contact.perception.scene_geoms import hidden_geoms
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.registry import make_world
from coral.errors import InputError
from coral.view.pictures import Image
from coral.view.run import RunFolder, read_table

Array = NDArray[np.float64]
FROM = np.array([0.6, -0.68, 0.42])
"""Direction of the camera: opposite the robot and to its right, where the arm occludes nothing."""
VFOV_DEG = 38.0


class ReplayedScene:
    """The simulated world of a run folder, set to its recorded states.

    Args:
        run: The run.
        size: Width and height of the pictures (px).

    Raises:
        InputError: The run has no recorded states, or those of another world.
        RunError: Its world cannot be built on this machine.
    """

    def __init__(self, run: RunFolder, size: tuple[int, int]) -> None:
        states = read_table(run.path / "states.csv")
        self.times: Array = states.get("t", np.zeros(0))
        if not len(self.times):
            raise InputError(str(run.path), "states.csv", "no states", "a run that kept them (record.states)")
        self.trial = trial_of_run(run)
        world = make_world(str(run.config.get("world", "hand")), self.trial, 0.02)
        try:
            if world.simulation is None:
                raise InputError(str(run.path), "world", repr(world.name), "a world that MuJoCo simulates")
            self._model = world.simulation.model
        finally:
            world.close()
        self._data = mujoco.MjData(self._model)
        self._places = np.stack([states[name] for name in states if name.startswith("q")], axis=1)
        if self._places.shape[1] != self._model.nq:
            raise InputError(
                str(run.path),
                "states.csv",
                f"{self._places.shape[1]} joint positions",
                f"the {self._model.nq} of its world",
            )
        camera = RgbdCameraCfg(width=size[0], height=size[1], vfov_deg=VFOV_DEG)
        self._camera = RayCamera(
            self._model,
            camera,
            _overview(run, self.trial),
            {},
            colours="shaded",
            hidden=hidden_geoms(self._model, self.trial),
        )

    def at(self, t: float) -> Image:
        """Draw the last state until `t`, Shape=(H, W, 3) RGB."""
        row = max(0, int(np.searchsorted(self.times, t + 1e-6)) - 1)
        self._data.qpos[:] = self._places[row]
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        picture = self._camera.take(self._data).rgb
        assert picture is not None
        return picture


def _overview(run: RunFolder, trial: Trial) -> Array:
    """Compute a T_world_camera that shows everything that moved, Shape=(4, 4)."""
    prefixes = ("", *(f"{name}_" for name in trial.objects))
    paths = [[run.column(f"{prefix}{axis}") for axis in "xyz"] for prefix in prefixes]
    points = np.concatenate([np.stack(path, axis=1) for path in paths])
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        points = np.zeros((1, 3))
    low, high = np.clip(points.min(axis=0), -0.6, 0.8), np.clip(points.max(axis=0), -0.6, 0.8)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 + 0.1
    return look_at(middle + FROM / np.linalg.norm(FROM) * radius / np.sin(np.radians(VFOV_DEG / 2)), middle)


def trial_of_run(run: RunFolder) -> Trial:
    """Sample the trial of a run again.

    Raises:
        InputError: The run has no task, or no seed.
    """
    path = Path(run.path) / "task.yaml"
    seed = run.config.get("seed")
    if not path.is_file() or not isinstance(seed, int):
        raise InputError(str(run.path), "", "no task.yaml and seed", "the folder of a contact run")
    return sample_trial(load_task(path), seed)
