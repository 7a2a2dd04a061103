"""Pictures as an MP4 file (H.264), and the strip below them that tells the state of the run."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from coral.drawing import RGB, Image, draw_text

INK, MUTED, TEAL, RED = (27, 39, 51), (93, 107, 122), (11, 100, 112), (200, 53, 43)


def write_mp4(path: Path, pictures: Iterable[Image], size: tuple[int, int], fps: float, *options: str) -> None:
    """Write pictures, Shape=(H, W, 3) RGB each, as a video; width and height are even, `options` are ffmpeg's."""
    import imageio_ffmpeg

    video = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=fps,
        codec="libx264",
        macro_block_size=2,
        quality=None,
        pix_fmt_out="yuv420p",
        output_params=[*options, "-preset", "veryfast", "-movflags", "+faststart"],
        ffmpeg_log_level="error",
    )
    video.send(None)
    for picture in pictures:
        video.send(np.ascontiguousarray(picture))
    video.close()


def draw_status(strip: Image, cells: Iterable[tuple[int, str, str, RGB]], size: int, done: float) -> None:
    """Draw values, in letters of a size (px), below their names, and which share of the run is over, 0 to 1, in place.

    The strip has Shape=(h, w, 3); a cell is x (px), name, value and colour.
    """
    height, width = strip.shape[:2]
    strip[:] = (244, 246, 248)
    for x, name, value, color in cells:
        draw_text(strip, name, x, height // 4, size=14, color=MUTED, weight=400)
        draw_text(strip, value, x, round(0.64 * height), size=size, color=color, weight=600)
    strip[-5:] = (214, 220, 226)
    cv2.rectangle(strip, (0, height - 5), (round((width - 1) * done), height - 1), TEAL, -1)
