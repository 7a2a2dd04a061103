"""A recording as a folder of colour pictures with their poses, and nothing else: what a diver's camera brings home."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from coral.config import read_yaml
from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.foreign_file import read_text
from coral.limits import TABLE_BYTES
from coral.reef.recordings.picture_files import encode_jpeg
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose
from coral.yaml_file import to_yaml

CAMERA = "camera.yaml"
COLUMNS = ("t", "x", "y", "z", "roll", "pitch", "yaw", "rgb")


def write_pictures(recording: Recording, path: Path) -> dict[str, int]:
    """Write a located recording as a folder that `read_folder` reads.

    Returns:
        Number of pictures.

    Raises:
        InputError: The path exists, or there are no colour pictures.
    """
    if path.exists():
        raise InputError(str(path), "--out", "something that exists already", "a new path")
    table, count = _row(COLUMNS), 0
    with scratch_for(path) as folder:
        for count, one in enumerate(recording.keyframes(), 1):
            name = f"{count:06d}.jpg"
            write_whole(folder / name, colour_of(one, recording))
            values = (one.t, one.pose.x, one.pose.y, one.height_m, one.roll, one.pitch, one.pose.theta)
            table += _row([*(f"{value:.9g}" for value in values), name])
        write_whole(folder / TABLE, table)
        write_whole(folder / CAMERA, to_yaml(_camera(recording.camera)))
    return {"pictures": count}


class PictureFolder:
    """A folder of pictures of one camera that grows picture by picture, as `read_folder` reads it."""

    def __init__(self, folder: Path, camera: CameraCfg) -> None:
        """Begin a folder, or continue one.

        Raises:
            InputError: It has pictures of another camera, or a table of another kind.
        """
        self._folder, self._camera = folder, camera
        self._rows, self._last = _row(COLUMNS), -1.0
        table = folder / TABLE
        if (folder / CAMERA).exists() or table.exists():
            known = read_yaml(folder / CAMERA) if (folder / CAMERA).is_file() else None
            if known != _camera(camera):
                raise InputError(str(folder), CAMERA, "another camera", "a folder for the pictures of one camera")
            self._rows = read_text(table, "a table of poses", TABLE_BYTES)
            head, *body = self._rows.splitlines()
            if _row(COLUMNS) != f"{head}\n" or not self._rows.endswith("\n"):
                raise InputError(str(table), "", f"columns {head}", ", ".join(COLUMNS))
            self._last = float(body[-1].partition(",")[0]) if body else -1.0

    def add(self, name: str, pose: Pose, t: float) -> None:
        """Add a picture, which lies in the folder, by its name; its time is a second after the last one at least."""
        self._last = max(t, self._last + 1.0)
        values = (self._last, pose.x, pose.y, self._camera.altitude_m, 0.0, 0.0, pose.theta)
        self._rows += _row([*(f"{value:.9g}" for value in values), name])
        write_whole(self._folder / TABLE, self._rows)
        write_whole(self._folder / CAMERA, to_yaml(_camera(self._camera)))


def _row(cells: Sequence[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(cells)
    return line.getvalue()


def export_pictures(recording: Recording, path: Path, only_colour: bool) -> dict[str, int]:
    """Write a folder of colour pictures of a survey with `poses.csv` and `camera.yaml`.

    See `write_pictures`.

    Raises:
        InputError: The path exists, there are no colour pictures, or `only_colour` is asked of what has nothing else.
    """
    if only_colour:
        raise InputError("--only-colour", "", "--to pictures", "--to mcap or --to bag")
    return write_pictures(recording, path)


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
