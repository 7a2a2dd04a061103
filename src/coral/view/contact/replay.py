"""The scene of a recorded episode at any moment, drawn by ray casting without OpenGL."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, hidden_geoms, instance_names, look_at
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.registry import make_world
from coral.drawing import Image
from coral.errors import InputError
from coral.run_files import TaskFiles
from coral.view.run import RunFolder, read_table

Array = NDArray[np.float64]
DIRECTIONS = np.array([[0.6, -0.68, 0.42], [0.6, 0.68, 0.42], [0.0, -0.9, 0.42], [0.0, 0.9, 0.42], [-0.5, -0.75, 0.42]])
"""Directions of the camera, the preferred one first: opposite the robot and to its right, where the arm occludes
nothing. Others are for scenes in which a wall or the like does."""
BETTER = 1.6
"""By so much more of the objects another direction must show."""
LOOKS, LOOK_SIZE = 8, (80, 60)
"""Moments at which the directions are compared, and the size of their pictures (px)."""
VFOV_DEG = 38.0


class ReplayedScene:
    """The simulated world of a run folder, set to its recorded states; pictures have width and height `size` (px).

    Raises:
        InputError: The run has no recorded states, or those of another world.
        RunError: Its world cannot be built on this machine.
    """

    def __init__(self, run: RunFolder, size: tuple[int, int]) -> None:
        states = read_table(run.path / TaskFiles.STATES)
        self.times: Array = states.get("t", np.zeros(0))
        if not len(self.times):
            raise InputError(str(run.path), TaskFiles.STATES, "no states", "a run that kept them (record.states)")
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
            found = f"{self._places.shape[1]} joint positions"
            raise InputError(str(run.path), TaskFiles.STATES, found, f"the {self._model.nq} of its world")
        middle, radius = _extent(run, self.trial)
        shown = [self._seen_from(overview(middle, radius, direction)) for direction in DIRECTIONS]
        best = int(np.argmax(shown)) if max(shown) > BETTER * shown[0] else 0
        self.direction: Array = DIRECTIONS[best]
        self._camera = scene_camera(self._model, self.trial, overview(middle, radius, self.direction), size)

    def at(self, t: float) -> Image:
        """Draw the last state until `t`, Shape=(H, W, 3) RGB."""
        self._put(max(0, int(np.searchsorted(self.times, t + 1e-6)) - 1))
        picture = self._camera.take(self._data).rgb
        assert picture is not None
        return picture

    def _put(self, row: int) -> None:
        self._data.qpos[:] = self._places[row]
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _seen_from(self, placed: Array) -> float:
        """Return how many pixels show objects that move, summed over moments of the run."""
        camera, total = scene_camera(self._model, self.trial, placed, LOOK_SIZE, names=True), 0
        for row in np.linspace(0, len(self.times) - 1, LOOKS).astype(int):
            self._put(int(row))
            picture = camera.take(self._data)
            total += sum(int(picture.mask(name).sum()) for name in self.trial.objects if name in picture.names)
        return float(total)


def _extent(run: RunFolder, trial: Trial) -> tuple[Array, float]:
    """Compute the middle, Shape=(3,), and the radius of everything that moved (m)."""
    prefixes = ("", *(f"{name}_" for name in trial.objects))
    paths = [[run.column(f"{prefix}{axis}") for axis in "xyz"] for prefix in prefixes]
    points = np.concatenate([np.stack(path, axis=1) for path in paths])
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        points = np.zeros((1, 3))
    low, high = np.clip(points.min(axis=0), -0.6, 0.8), np.clip(points.max(axis=0), -0.6, 0.8)
    return (low + high) / 2, float(np.linalg.norm(high - low)) / 2 + 0.1


def scene_camera(
    model: mujoco.MjModel, trial: Trial, placed: Array, size: tuple[int, int], names: bool = False
) -> RayCamera:
    """Make a camera of a simulated scene at `placed`, T_world_camera, Shape=(4, 4), for pictures of a size (px).

    With `names`, pictures hold which thing each pixel shows instead of colours.
    """
    return RayCamera(
        model,
        RgbdCameraCfg(width=size[0], height=size[1], vfov_deg=VFOV_DEG),
        placed,
        instance_names(model, trial) if names else {},
        colours=not names,
        hidden=hidden_geoms(model, trial),
    )


def overview(middle: Array, radius: float, direction: Array = DIRECTIONS[0]) -> Array:
    """Compute a T_world_camera that shows a ball, with centre Shape=(3,) and radius (m), from a direction."""
    away = radius / np.sin(np.radians(VFOV_DEG / 2))
    return look_at(middle + direction / np.linalg.norm(direction) * away, middle)


def trial_of_run(run: RunFolder) -> Trial:
    """Sample the trial of a run again.

    Raises:
        InputError: The run has no task, or no seed.
    """
    path = Path(run.path) / TaskFiles.TASK
    seed = run.config.get("seed")
    if not path.is_file() or not isinstance(seed, int):
        raise InputError(str(run.path), "", "no task.yaml and seed", "the folder of a contact run")
    return sample_trial(load_task(path), seed)
