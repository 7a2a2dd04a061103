"""Data of a reef report's time slider: motion, decisions, snapshots, and the pictures of its questions."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import palette_png, png_url, webp_url
from coral.foreign_file import read_picture_file
from coral.reef.pictures.cameraview import DEPTH_PALETTE, LABEL_COLORS, depth_levels
from coral.view.charts import LEFT, RIGHT, WIDTH
from coral.view.decisions import Decision, chains
from coral.view.mapsvg import map_uri
from coral.view.run import RunFolder

FRAME_BUDGET = 3_000_000
"""Maximum size of the time slider's snapshots in the page (bytes)."""
PICTURE_BUDGET = 3_000_000
"""Maximum size of the advisor's pictures in the page (bytes)."""
PICTURE_SIZES = ((768, 80), (560, 75), (400, 65), (280, 55))
"""(Width px, quality) tried in turn until the pictures fit."""


def shown_pictures(run: RunFolder, made: Sequence[Decision]) -> dict[str, str]:
    """Return data URLs of the pictures shown, by digest; the more pictures, the smaller each one."""
    wanted = {digest for d in made for one in d.tries for _, digest in one.pictures}
    found = {digest: path for digest in sorted(wanted) if (path := run.picture(digest)) is not None}
    # Large ones are shrunk at once: a run may name hundreds.
    images = {
        digest: _shrunk(image, PICTURE_SIZES[0][0])
        for digest, path in found.items()
        if (image := read_picture_file(path, cv2.IMREAD_COLOR)) is not None
    }
    encoded: dict[str, str] = {}
    for width, quality in PICTURE_SIZES:
        encoded = {}
        for digest, image in images.items():
            encoded[digest] = webp_url(_shrunk(image, width)[..., ::-1], quality)
            if sum(map(len, encoded.values())) > PICTURE_BUDGET:
                break
        else:
            break
    return encoded


def _shrunk(image: NDArray[Any], width: int) -> NDArray[Any]:
    scale = min(1.0, width / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else image
    return np.asarray(small)


def script_data(run: RunFolder, made: Sequence[Decision], pictures: Mapping[str, str]) -> str:
    """Return the data of the time slider, as JSON that is safe inside a script element."""
    t = run.column("t")
    stride = max(1, -(-len(t) // 1500))
    keep = np.unique(np.append(np.arange(0, len(t), stride), max(len(t) - 1, 0))) if len(t) else np.zeros(0, int)
    speed = np.hypot(run.column("u"), run.column("v"))

    def column(values: Any, digits: int) -> list[float | None]:
        return [round(float(v), digits) if math.isfinite(v) else None for v in values[keep]]

    data = {
        "t": column(t, 2),
        "x": column(run.column("x"), 3),
        "y": column(run.column("y"), 3),
        "a": column(run.column("theta"), 3),
        "s": column(speed, 3),
        "c": column(run.column("clearance"), 2),
        "k": column(run.column("coverage"), 4),
        "gx": column(run.column("goal_x"), 2),
        "gy": column(run.column("goal_y"), 2),
        "end": round(run.duration_s, 2),
        "plot": [LEFT, WIDTH - RIGHT, WIDTH],
        "frames": _frames(run),
        "pictures": dict(pictures),
        "chains": [
            [t, [[c["index"], c["x"], c["y"], bool(c.get("visited"))] for c in chain]] for t, chain in chains(run)
        ],
        "decisions": [
            {"n": d.number, "t": d.t, "end": d.end_s, "mode": d.mode, "cause": d.cause, "tries": len(d.tries)}
            | {"said": d.tries[-1].said, "verdict": d.outcome, "why": d.tries[-1].why[:600]}
            for d in made
        ],
    }
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _frames(run: RunFolder) -> list[dict[str, Any]]:
    """Return snapshots for the time slider, as many as the budget allows, the last one always included."""
    steps = list(run.frame_steps)
    if not steps:
        return []
    times = dict(zip(run.column("step").tolist(), run.column("t").tolist(), strict=True))
    stride = 1
    while True:
        chosen = sorted({*steps[::stride], steps[-1]})
        frames, size = [], 0
        for step in chosen:
            frame = {"t": round(times.get(float(step), step / run.steps_per_s), 2), **_snapshot(run, step)}
            size += sum(len(value) for value in frame.values() if isinstance(value, str))
            if size > FRAME_BUDGET:
                break
            frames.append(frame)
        else:
            return frames
        stride = max(stride + 1, math.ceil(stride * len(chosen) / max(len(frames), 1)))


def _snapshot(run: RunFolder, step: int) -> dict[str, str]:
    """Return small pictures of one moment as data URLs; unreadable ones are left out."""
    found = {}
    cells, labels, depth = (run.frame(step, kind) for kind in ("map", "labels", "depth"))
    if cells is not None:
        found["map"] = map_uri(cells)
    if labels is not None:
        found["seg"] = png_url(palette_png(np.minimum(labels, len(LABEL_COLORS) - 1), LABEL_COLORS))
    if depth is not None:
        # Coarser depth steps compress to a third; the pure "nothing" colour keeps its own entry.
        levels = depth_levels(np.asarray(depth * 1e-3, np.float32)) // 8 * 8
        levels = np.where(depth == 0, 255, levels).astype(np.uint8)
        found["dep"] = png_url(palette_png(np.minimum(levels, len(DEPTH_PALETTE) - 1), DEPTH_PALETTE))
    colours = run.frame(step, "rgb")
    if colours is not None:
        found["rgb"] = webp_url(colours[..., ::-1], 75)
    return found
