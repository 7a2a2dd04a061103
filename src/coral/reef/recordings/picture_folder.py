"""A folder of pictures with their poses in a table, `poses.csv`: what a diver's camera brings home."""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from coral.config import read_yaml
from coral.drawing import jpeg
from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.foreign_file import read_head, read_orientation, read_text
from coral.limits import LARGEST_NUMBER, LATEST_S, TABLE_BYTES
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.recordings.local_plane import MOST_DEGREES, LocalPlane
from coral.reef.recordings.recorded_pictures import PicturePerception, read_picture, recorded_frame
from coral.reef.recordings.recording import RECORDED, PosedFrame, Recording
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose, wrap
from coral.yaml_file import to_yaml

TABLE = "poses.csv"
Row = tuple[str, dict[str, float], dict[str, str]]
"""Place in the table or the folder, for errors; numbers; names of pictures."""
LOCAL = ("x", "y", "yaw")
GLOBAL = ("lat", "lon", "heading")
"""Names of the columns of a position: metres and radians, or degrees with the compass heading."""
EXPECTED = "columns t, x, y, yaw or t, lat, lon, heading; z, roll, pitch, rgb, depth, labels if known"
FASTEST_M_S, FIX_M = 20.0, 30.0
"""No vehicle in the water is faster, and no fix of a satellite receiver is further off without being a bad one."""
_TURNS = {
    "heading": "the compass heading of the camera, in degrees from north; a position alone does not tell it",
    "yaw": "the direction of the camera, in radians from east; a position alone does not tell it",
}
_DECIMAL_COMMA = re.compile(r"[-+]?\d{1,12},\d{1,20}", re.ASCII)
EXIF_BYTES = 300_000
"""Exif tags lie in the first 64 kB of a JPEG file, behind at most a few other segments."""
PICTURES = ("rgb", "depth", "labels", "doubt")
"""Columns of pictures; a run of a network has doubt."""
LENS_KEYS = ("width", "height", "hfov_deg", "pitch_down_deg", "altitude_m", "range_m", "near_m")
LENS = "camera.yaml"
COLUMNS = ("t", "x", "y", "z", "roll", "pitch", "yaw", "rgb")


def read_folder(
    path: Path, camera: RecordedCamera, perception: PicturePerception | None = None, period_s: float = 0.0
) -> Recording:
    """Read a folder of pictures, named in its `poses.csv`, `period_s` (s) apart at least.

    With `perception`, what they show is what that sees in their colours, whatever else the folder has of them.

    Raises:
        InputError: The table is missing or a value in it is wrong. Pictures are checked when they are read.
    """
    return placed_pictures(path, path / TABLE, read_rows(path / TABLE), camera, perception, period_s)


def placed_pictures(
    path: Path,
    table: Path,
    rows: list[Row],
    camera: RecordedCamera,
    perception: PicturePerception | None,
    period_s: float,
) -> Recording:
    """Make a recording of pictures with poses, as for `read_folder`; rows are columns of `poses.csv`, one at least.

    Raises:
        InputError: Between two rows lies a way that no vehicle drives.
    """
    plane = LocalPlane(rows[0][1]["lat"], rows[0][1]["lon"]) if "lat" in rows[0][1] else None
    placed = [(place, _pose(values, plane), values, names) for place, values, names in rows]
    for (_, (before, _), earlier, _), (place, (pose, _), values, _) in itertools.pairwise(placed):
        away, later = math.dist(before[:2], pose[:2]), values["t"] - earlier["t"]
        if away > FIX_M + FASTEST_M_S * later:
            field = f"{place}: {'lat, lon' if plane else 'x, y'}"
            found = f"{away:.0f} m from the line before it, {later:g} s later"
            raise InputError(str(table), field, found, "a track that a vehicle can have driven; leave bad fixes out")

    def keyframes() -> Iterator[PosedFrame]:
        due = -math.inf
        for place, (pose, odometry), values, names in placed:
            if values["t"] < due - 1e-6:
                continue
            due = values["t"] + period_s
            height_m = values.get("z", camera.view.altitude_m)
            attitude = CameraAttitude(height_m, values.get("roll", 0.0), values.get("pitch", 0.0))
            where = f"{table}: {place}"
            images = {each: partial(read_picture, path / file, where, each) for each, file in names.items() if file}
            frame = recorded_frame(images, camera, perception, attitude, where)
            yield PosedFrame(
                t=values["t"], pose=pose, height_m=height_m, frame=frame, roll=attitude.roll, pitch=attitude.pitch,
                odometry=odometry,
            )  # fmt: skip

    return Recording(
        name=path.resolve().name, source=str(path), camera=camera.view, keyframes=keyframes, start=placed[0][1][0],
        seen_by=perception.name if perception else RECORDED,
        datum=None if plane is None else (plane.latitude, plane.longitude),
        remarks=_turned(path, [names.get("rgb", "") for _, _, _, names in placed]),
    )  # fmt: skip


def _turned(path: Path, names: list[str]) -> tuple[str, ...]:
    """Return a line if a picture says that it should be turned: it is not."""
    for name in filter(None, names):
        try:
            found = read_orientation(read_head(path / name, "a picture", EXIF_BYTES))
        except InputError:  # told when it is read as a picture
            continue
        if found != 1:
            return (f"{name} has EXIF orientation {found}: pixels are used as they lie in the file",)
    return ()


def _pose(values: dict[str, float], plane: LocalPlane | None) -> tuple[Pose, Pose | None]:
    if plane is not None:
        east, north = plane.from_degrees(values["lat"], values["lon"])
        return Pose(east, north, wrap(math.radians(90.0 - values["heading"]))), None
    odometry = Pose(values["odo_x"], values["odo_y"], values["odo_yaw"]) if "odo_yaw" in values else None
    return Pose(values["x"], values["y"], values["yaw"]), odometry


def read_rows(
    table: Path, places: tuple[tuple[str, ...], ...] = (LOCAL, GLOBAL), expected: str = EXPECTED
) -> list[Row]:
    """Return every complete row of a table, which must have one of the groups of columns in `places`.

    Raises:
        InputError: It is no such table, or a value in it is wrong.
    """
    where = str(table)
    text = read_text(table, "a table of poses", TABLE_BYTES)
    lines = text.splitlines()
    comma = ";" if lines and lines[0].count(";") > lines[0].count(",") else ","
    try:
        header, *body = list(csv.reader(lines, delimiter=comma)) or [[]]
    except csv.Error as error:
        raise InputError(where, "", error, expected) from None
    header = [name.strip() for name in header]
    if body and not text.endswith("\n") and not _is_whole(body[-1], header, table.parent):
        body.pop()  # the line that a killed run was writing
    place = next((names for names in places if set(names) <= set(header)), None)
    if place is None or "t" not in header:
        turn = next((last for *at, last in filter(None, places) if {"t", *at} <= set(header)), None)
        columns = f"columns {', '.join(header) or 'none'}" + (f" without {turn}" if turn else "")
        raise InputError(where, turn or "", columns, _TURNS.get(turn or "", expected))
    if not body:
        raise InputError(where, "", "no rows", "a row for each picture")
    texts = [name for name in PICTURES if name in header]
    numbers = [
        name
        for name in ("t", *place, "z", "roll", "pitch", "odo_x", "odo_y", "odo_yaw")
        if name in header and not (place == GLOBAL and name.startswith("odo"))
    ]
    found: list[Row] = []
    for number, row in enumerate(body, 2):
        if len(row) != len(header):
            raise InputError(where, f"line {number}", f"{len(row)} fields", f"{len(header)}, as in the first line")
        cells = dict(zip(header, (value.strip() for value in row), strict=True))
        values = {name: _number(cells[name], where, number, name) for name in numbers}
        if place == GLOBAL and not (abs(values["lat"]) <= MOST_DEGREES and abs(values["lon"]) <= 180.0):
            raise InputError(
                where,
                f"line {number}: lat, lon",
                f"{values['lat']:g}, {values['lon']:g}",
                f"degrees within {MOST_DEGREES:.0f} and 180",
            )
        if place == GLOBAL and not (values["lat"] or values["lon"]):
            raise InputError(where, f"line {number}: lat, lon", "0, 0, a receiver without a fix", "lines with a fix")
        if found and values["t"] < found[-1][1]["t"]:
            raise InputError(where, f"line {number}: t", cells["t"], "times that never go back")
        if values.get("z", 1.0) <= 0.0:
            raise InputError(where, f"line {number}: z", cells["z"], "a height above the sea floor, above 0 m")
        found.append((f"line {number}", values, {name: cells[name] for name in texts}))
    return found


def _is_whole(row: list[str], header: list[str], folder: Path) -> bool:
    """Check whether a last row without a line end was not cut off: it has all fields, and its pictures are there."""
    named = dict(zip(header, row, strict=False))
    pictures = [named[name].strip() for name in PICTURES if name in named]
    return len(row) == len(header) and all((folder / name).is_file() for name in pictures if name)


def _number(text: str, where: str, line: int, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    most = LATEST_S if name == "t" else LARGEST_NUMBER
    if not abs(value) <= most:
        expected = f"a number of at most {most:g}"
        if _DECIMAL_COMMA.fullmatch(text):
            expected = f"a decimal point, as in {text.replace(',', '.')}, not a decimal comma: replace it in all lines"
        raise InputError(where, f"line {line}: {name}", repr(text)[:40], expected)
    return value


def export_pictures(recording: Recording, path: Path) -> dict[str, int]:
    """Write the colour pictures of a located recording and their poses, and nothing else, for `read_folder`.

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
    return {name: getattr(camera, name) for name in LENS_KEYS}
