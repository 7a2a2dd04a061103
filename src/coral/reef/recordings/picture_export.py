"""A recording as a folder of colour pictures with their poses, and nothing else: what a diver's camera brings home."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from coral.config import read_yaml
from coral.drawing import jpeg
from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.foreign_file import read_text
from coral.limits import TABLE_BYTES
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recording import Recording
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose
from coral.yaml_file import to_yaml

CAMERA = ("width", "height", "hfov_deg", "pitch_down_deg", "altitude_m", "range_m", "near_m")
LENS = "camera.yaml"
"""The file of these keys."""
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
            write_whole(folder / name, jpeg(one.frame.rgb))
            rows.append(_row(one.t, one.pose, one.height_m, one.roll, one.pitch, name))
        _write(folder, rows, recording.camera)
    return {"pictures": len(rows) - 1}


def table_of(folder: Path, camera: CameraCfg) -> list[str]:
    """Return the table of a folder of pictures that grows, header first; the header alone where it begins.

    Raises:
        InputError: The folder has pictures of another camera, or a table of another kind.
    """
    table, header = folder / TABLE, ",".join(COLUMNS)
    if not (table.exists() or (folder / LENS).exists()):
        return [header]
    if not (folder / LENS).is_file() or read_yaml(folder / LENS) != _camera(camera):
        raise InputError(str(folder), LENS, "another camera", "a folder for the pictures of one camera")
    rows = read_text(table, "a table of poses", TABLE_BYTES).splitlines()
    if rows[:1] != [header]:
        raise InputError(str(table), "", f"columns {''.join(rows[:1])}", header)
    return rows


def add_picture(folder: Path, rows: Sequence[str], camera: CameraCfg, name: str, pose: Pose, t: float) -> None:
    """Add a picture, which lies in the folder, to its table; its time is a second after the last one at least."""
    last = float(rows[-1].partition(",")[0]) if len(rows) > 1 else -1.0
    _write(folder, [*rows, _row(max(t, last + 1.0), pose, camera.altitude_m, 0.0, 0.0, name)], camera)


def _row(t: float, pose: Pose, height_m: float, roll: float, pitch: float, name: str) -> str:
    values = [f"{value:.9g}" for value in (t, pose.x, pose.y, height_m, roll, pitch, pose.theta)]
    quoted = f'"{name.replace(chr(34), chr(34) * 2)}"' if set(name) & set(',"') else name
    return ",".join([*values, quoted])


def _write(folder: Path, rows: Sequence[str], camera: CameraCfg) -> None:
    write_whole(folder / TABLE, "".join(f"{row}\n" for row in rows))
    write_whole(folder / LENS, to_yaml(_camera(camera)))


def _camera(camera: CameraCfg) -> dict[str, float]:
    return {name: getattr(camera, name) for name in CAMERA}
