"""The map of a recorded run at any moment, drawn by the same renderer as the advisor's; `map.png`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.drawing import Image, png
from coral.file_writer import write_whole, writing
from coral.reef.decide.said import said_by
from coral.reef.pictures.mapview import MapScene, draw_map
from coral.reef.world.geometry import Pose
from coral.run_files import SurveyFiles
from coral.view.decisions import chain_at
from coral.view.run import RunFolder


def write_map(run: RunFolder) -> Path:
    """Write `map.png`, the final map of a run, into its folder and return its path.

    Raises:
        InputError: The picture cannot be written.
    """
    path = run.path / SurveyFiles.MAP
    with writing(path):
        write_whole(path, png(draw_map(scene_at(run, run.duration_s)).rgb))
    return path


def scene_at(run: RunFolder, t: float, cells: NDArray[np.uint8] | None = None) -> MapScene:
    """Return the robot's map and state at time `t` (s), as far as recorded.

    `cells` are the map's classes, Shape=(H, W), by default of the last snapshot that is no later than `t`.
    """
    pose, track, goal = _state_at(run, t)
    offered = chain_at(run, t)
    size = run.world.get("size_m") or (20.0, 20.0)
    if cells is None:
        cells = snapshot(run, t)
    cell_m = float(size[0]) / cells.shape[1] if cells is not None else 0.05
    if cells is None:
        cells = np.zeros((round(float(size[1]) / cell_m), round(float(size[0]) / cell_m)), np.uint8)
    return MapScene(
        cells=cells,
        cell_m=cell_m,
        pose=pose,
        trajectory=track,
        centroids=np.array([(float(c["x"]), float(c["y"])) for c in offered], np.float64).reshape(-1, 2),
        indices=[int(c["index"]) for c in offered],
        visited=[bool(c.get("visited")) for c in offered],
        goal=goal,
        marks=[(one.x, one.y, one.name) for one in said_by(run.events, t)],
    )


def _state_at(run: RunFolder, t: float) -> tuple[Pose | None, NDArray[np.float64], tuple[float, float] | None]:
    """Return the pose at `t`, the track up to there, Shape=(N, 2), and the goal; None if not recorded."""
    k = int(np.searchsorted(run.column("t"), t + 1e-6))
    x, y, theta = (_interpolate(run, name, t, k) for name in ("x", "y", "theta"))
    pose = Pose(x, y, theta) if k and np.isfinite([x, y, theta]).all() else None
    track = np.stack([run.column("x")[:k], run.column("y")[:k]], axis=1)
    if pose is not None:
        track = np.vstack([track, [pose[:2]]])
    goal = (run.column("goal_x")[k - 1], run.column("goal_y")[k - 1]) if k else (np.nan, np.nan)
    return (
        pose,
        track[np.isfinite(track).all(axis=1)],
        (float(goal[0]), float(goal[1])) if np.isfinite(goal).all() else None,
    )


def snapshot(run: RunFolder, t: float) -> Image | None:
    """Return the map classes of the last snapshot no later than `t`, Shape=(H, W); None if there is none."""
    found = step_at(run, t)
    cells = run.frame(found, "map") if found is not None else None
    return None if cells is None else np.minimum(cells, 3).astype(np.uint8)


def step_at(run: RunFolder, t: float) -> int | None:
    """Return the step of the last snapshot no later than `t` (s), or the first one; None without any."""
    past = [step for step in run.frame_steps if step <= t * run.steps_per_s + 1e-6]
    return next(iter(past[-1:] or run.frame_steps), None)


def _interpolate(run: RunFolder, name: str, t: float, k: int) -> float:
    """Interpolate a column at `t`, where `k` is the first sample after it; nan without samples."""
    times, values = run.column("t"), run.column(name)
    if not len(times):
        return float("nan")
    if name == "theta":
        values = values.copy()
        near = slice(max(k - 1, 0), k + 1)
        values[near] = np.unwrap(values[near])
    return float(np.interp(t, times, values))
