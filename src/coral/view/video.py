"""A run as a short video: the growing map, the camera pictures, and the decisions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from coral.drawing import Image, draw_text
from coral.errors import InputError
from coral.file_writer import scratch_for, writing
from coral.reef.pictures.cameraview import Kind, camera_picture
from coral.reef.pictures.mapview import draw_map
from coral.run_files import SurveyFiles
from coral.view.decisions import Decision, decisions
from coral.view.mp4 import INK, MUTED, RED, TEAL, draw_status, write_mp4
from coral.view.run import RunFolder, read_camera_frame
from coral.view.runmap import scene_at, snapshot, step_at
from coral.words import clock

WIDTH, HEIGHT = 1080, 720
STRIP = 72
"""Height of the status strip below the pictures (px)."""
EYE = (432, 324)
FPS = 12
LONGEST_S = 28.0
"""Maximum length of the video; a long mission plays faster."""
FINEST_S = 0.5
"""Simulated time between two pictures of a short mission."""


def write_video(run_folder: str | Path) -> Path:
    """Write `mission.mp4` (H.264) into a run folder and return its path.

    Raises:
        InputError: The folder has no run or no snapshots, or the video cannot be written.
    """
    run = RunFolder.read(run_folder)
    if not run.frame_steps or not run.kept_pictures:
        raise InputError(str(run.path), SurveyFiles.FRAMES, "no snapshots", "a run that kept its frames")
    path = run.path / SurveyFiles.VIDEO
    with writing(path), scratch_for(path) as scratch:
        write_mp4(scratch, pictures(run), (WIDTH, HEIGHT), FPS, "-crf", "27")
    return path


def moments(duration_s: float) -> list[float]:
    """Choose the times (s) of the video's pictures, evenly spaced from the start to the end of the run."""
    count = max(2, min(math.floor(duration_s / FINEST_S) + 1, round(LONGEST_S * FPS)))
    return [float(t) for t in np.linspace(0.0, duration_s, count)]


def pictures(run: RunFolder) -> Iterator[Image]:
    """Draw the video picture by picture, Shape=(HEIGHT, WIDTH, 3) RGB each."""
    made = decisions(run)
    size = run.world.get("size_m") or (20.0, 20.0)
    window = 0.0, 0.0, float(size[0]), float(size[1])
    calls = [float(e["t"]) for e in run.select("question")]
    collisions = [float(e["t"]) for e in run.select("collision")]
    shown, cells, eyes = -1, None, np.full((2 * EYE[1], EYE[0], 3), 235, np.uint8)
    for t in moments(run.duration_s):
        step = step_at(run, t)
        if step is not None and step != shown:
            shown, cells = step, snapshot(run, t)
            eyes = _camera_pictures(run, step)
        canvas = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
        chart = draw_map(scene_at(run, t, cells), size_px=HEIGHT - STRIP, window=window, legend=False).rgb
        top, left = (HEIGHT - STRIP - chart.shape[0]) // 2, (WIDTH - EYE[0] - chart.shape[1]) // 2
        canvas[top : top + chart.shape[0], left : left + chart.shape[1]] = chart
        canvas[: 2 * EYE[1], WIDTH - EYE[0] :] = eyes
        _strip(canvas, run, made, t, sum(c <= t for c in calls), sum(c <= t for c in collisions))
        yield canvas


def _camera_pictures(run: RunFolder, step: int) -> Image:
    """Draw the camera's colours, or its classes, above depth, Shape=(2 EYE[1], EYE[0], 3)."""
    frame = read_camera_frame(run.path, step)
    if frame is None:
        return np.full((2 * EYE[1], EYE[0], 3), 235, np.uint8)
    upper: Kind = "segmentation" if frame.rgb is None else "colour"
    both = np.vstack([camera_picture(frame, upper, EYE), camera_picture(frame, "depth", EYE)])
    title = "camera: oysters green, obstacles dark" if frame.rgb is None else "camera"
    for row, name in ((0, title), (EYE[1], "depth")):
        draw_text(both, name, 10, row + 16, size=15, weight=600, halo=2)
    return both


def _strip(canvas: Image, run: RunFolder, made: Sequence[Decision], t: float, calls: int, collisions: int) -> None:
    strip = canvas[HEIGHT - STRIP :]
    times, coverage = run.column("t"), run.column("coverage")
    k = max(0, int(np.searchsorted(times, t + 1e-6)) - 1)
    seen = float(coverage[k]) if len(coverage) and math.isfinite(coverage[k]) else 0.0
    cells = (
        (16, "time", clock(t), INK),
        (116, "coverage", f"{seen:.0%}", TEAL),
        (226, "collisions", str(collisions), RED if collisions else INK),
        (336, "advisor calls", str(calls), INK),
    )
    draw_status(strip, cells, 26, t / max(run.duration_s, 1e-6))
    last = next((d for d in reversed(made) if d.t <= t + 1e-6), None)
    if last is not None:
        waiting = t < last.end_s or last.outcome == "open"
        state = "the advisor is thinking" if waiting else f"{last.tries[-1].said}, {last.outcome}"
        asked = f"decision {last.number}: asked at {clock(last.t)} ({last.cause or 'asked'})"
        draw_text(strip, asked, 456, 18, size=14, color=MUTED, weight=400)
        draw_text(strip, state[:60], 456, 45, size=18, weight=600)
