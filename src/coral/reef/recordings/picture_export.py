"""A recording as a folder of colour pictures with their poses, and nothing else: what a diver's camera brings home."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.reef.recordings.picture_files import encode_jpeg
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.vehicle.camera import CameraCfg
from coral.yaml_file import to_yaml

COLUMNS = ("t", "x", "y", "z", "roll", "pitch", "yaw", "rgb")


def write_pictures(recording: Recording, path: Path) -> dict[str, int]:
    """Write a located recording as a folder that `read_folder` reads.

    Returns:
        Number of pictures.

    Raises:
        InputError: The path exists, or there are no colour pictures.
    """
    if path.exists():
        raise InputError(str(path), "--out", "something there already", "a new path")
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    rows.writerow(COLUMNS)
    count = 0
    with scratch_for(path) as folder:
        for count, one in enumerate(recording.keyframes(), 1):
            name = f"{count:06d}.jpg"
            write_whole(folder / name, colour_of(one, recording))
            values = (one.t, one.pose.x, one.pose.y, one.height_m, one.roll, one.pitch, one.pose.theta)
            rows.writerow([*(f"{value:.9g}" for value in values), name])
        write_whole(folder / TABLE, table.getvalue())
        write_whole(folder / "camera.yaml", to_yaml(_camera(recording.camera)))
    return {"pictures": count}


def colour_of(keyframe: PosedFrame, recording: Recording) -> bytes:
    """Return the colour picture of a keyframe as a JPEG file.

    Raises:
        InputError: It has none.
    """
    if keyframe.frame.rgb is None:
        raise InputError(
            recording.source, "", f"no colour picture at {keyframe.t:g} s", "a run with --cfg.simulator.pictures"
        )
    return encode_jpeg(keyframe.frame.rgb)


def _camera(camera: CameraCfg) -> dict[str, float]:
    names = ("width", "height", "hfov_deg", "pitch_down_deg", "altitude_m", "range_m", "near_m")
    return {name: getattr(camera, name) for name in names}
