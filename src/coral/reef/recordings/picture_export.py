"""A recording as a folder of colour pictures with their poses, and nothing else: what a diver's camera brings home."""

from __future__ import annotations

from pathlib import Path

from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.reef.recordings.picture_files import encode_jpeg
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recording import Recording
from coral.yaml_file import to_yaml

CAMERA = ("width", "height", "hfov_deg", "pitch_down_deg", "altitude_m", "range_m", "near_m")
"""Keys of camera.yaml."""
COLUMNS = ("t", "x", "y", "z", "roll", "pitch", "yaw", "rgb")


def export_pictures(recording: Recording, path: Path) -> dict[str, int]:
    """Write a located recording as a folder that `read_folder` reads.

    Returns:
        Number of pictures.

    Raises:
        InputError: The path exists, or there are no colour pictures.
    """
    if path.exists():
        raise InputError(str(path), "--out", "something that exists already", "a new path")
    rows = [",".join(COLUMNS)]
    with scratch_for(path) as folder:
        for count, one in enumerate(recording.keyframes(), 1):
            name = f"{count:06d}.jpg"
            if one.frame.rgb is None:
                found = f"no colour picture at {one.t:g} s"
                raise InputError(recording.source, "", found, "a run with --cfg.simulator.pictures")
            write_whole(folder / name, encode_jpeg(one.frame.rgb))
            values = (one.t, one.pose.x, one.pose.y, one.height_m, one.roll, one.pitch, one.pose.theta)
            rows.append(",".join([*(f"{value:.9g}" for value in values), name]))
        write_whole(folder / TABLE, "".join(f"{row}\n" for row in rows))
        write_whole(folder / "camera.yaml", to_yaml({name: getattr(recording.camera, name) for name in CAMERA}))
    return {"pictures": len(rows) - 1}
