"""A contact episode as a short video: the scene, the stage, and the force on the objects."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from coral.drawing import Image, draw_text
from coral.file_writer import scratch_for, writing
from coral.run_files import TaskFiles
from coral.view.contact.figures import stage_spans
from coral.view.contact.replay import ReplayedScene
from coral.view.mp4 import INK, MUTED, RED, TEAL, draw_status, write_mp4
from coral.view.run import RunFolder

WIDTH, HEIGHT = 640, 480
STRIP = 56
"""Height of the status strip below the scene (px)."""
FPS = 12.5
LONGEST_S = 40.0
"""Maximum length of the video; a longer episode plays faster than real time."""


def write_contact_video(run_folder: str | Path) -> Path:
    """Write `episode.mp4` (H.264) into a run folder and return its path.

    Raises:
        InputError: The folder has no contact run or no states, or the video cannot be written.
        RunError: Its world cannot be built on this machine.
    """
    run = RunFolder.read(run_folder)
    scene = ReplayedScene(run, (WIDTH, HEIGHT))
    path = run.path / TaskFiles.VIDEO
    with writing(path), scratch_for(path) as scratch:
        write_mp4(scratch, pictures(run, scene), (WIDTH, HEIGHT + STRIP), FPS, "-crf", "24")
    return path


def moments(duration_s: float) -> list[float]:
    """Choose the times (s) of the video's pictures: real time, or faster if that would take too long."""
    count = max(2, round(min(duration_s, LONGEST_S) * FPS) + 1)
    return [float(t) for t in np.linspace(0.0, duration_s, count)]


def pictures(run: RunFolder, scene: ReplayedScene) -> Iterator[Image]:
    """Draw the video picture by picture, Shape=(HEIGHT + STRIP, WIDTH, 3) RGB each."""
    spans = stage_spans(run)
    times = run.column("t")
    forces = np.stack([run.column(f"{name}_hand_force") for name in scene.trial.objects]).max(axis=0)
    rate = run.duration_s / LONGEST_S
    outcome = str(run.metrics.get("end_reason", ""))
    for t in moments(run.duration_s):
        canvas = np.empty((HEIGHT + STRIP, WIDTH, 3), np.uint8)
        canvas[:HEIGHT] = scene.at(t)
        stage = next((name for start, end, name in reversed(spans) if start <= t + 1e-6), "")
        row = max(0, int(np.searchsorted(times, t + 1e-6)) - 1)
        force = float(forces[row]) if len(forces) else 0.0
        over = t >= run.duration_s - 1e-6 and outcome
        cells = (
            (16, "time", f"{t:.1f} s", INK),
            (130, "stage", stage[:28], TEAL),
            (420, "force", f"{force:.1f} N" if np.isfinite(force) else "unknown", INK),
            (530, "outcome", outcome[:14] if over else "", TEAL if outcome == "success" else RED),
        )
        draw_status(canvas[HEIGHT:], cells, 19, t / max(run.duration_s, 1e-6))
        if rate > 1:
            draw_text(canvas, f"{rate:.1f}× real time", WIDTH - 10, 16, size=14, color=MUTED, anchor="rm", halo=2)
        yield canvas
