"""Pictures as an MP4 file (H.264)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from coral.drawing import Image


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
