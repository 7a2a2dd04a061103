"""Pictures or a video of a dive with the autopilot's log, in place of `poses.csv`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from coral.errors import InputError
from coral.reef.recordings.autopilot_log import SUFFIXES, UNIX_S, read_log, tell_span
from coral.reef.recordings.picture_folder import Row, placed_pictures
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.recordings.timed_pictures import TimedPictures, find_pictures
from coral.reef.sea.recorded_camera import RecordedCamera


def find_log(path: Path) -> Path | None:
    """Return the only log of a folder, or the path if it is a log; None without one.

    Raises:
        InputError: There are several.
    """
    if path.is_file():
        return path if path.suffix.lower() in SUFFIXES else None
    logs = sorted(one for one in path.glob("*") if one.suffix.lower() in SUFFIXES)
    if len(logs) > 1:
        found = ", ".join(one.name for one in logs[:4])
        raise InputError(str(path), "", f"logs {found}", f"one of them: coral reef map {logs[0]}")
    return logs[0] if logs else None


def read_log_folder(
    log: Path,
    camera: RecordedCamera,
    perception: PicturePerception | None = None,
    period_s: float = 0.0,
    start_s: float | None = None,
) -> Recording:
    """Read the pictures or the video beside a log, with the poses that it has for them, as `read_folder` does.

    The camera counts as being where the log's position is. Its height is that of a range finder in the log, otherwise
    the camera's. `start_s` is the time of the log at which the first picture was taken (s); None: both clocks agree.

    Raises:
        InputError: Log or pictures cannot be read, their times have nothing in common, or the height is unknown.
    """
    folder, where = log.parent, str(log)
    track = read_log(log)
    pictures = find_pictures(folder, camera.size)
    if not (track.range.times or camera.altitude_given):
        raise InputError(
            where, "height above the sea floor", "no range finder", "altitude_m in the camera's file: the usual height"
        )
    unknown = start_s is None and not (pictures.is_universal and min(track.span[0], pictures.span[0]) >= UNIX_S)
    shift = 0.0 if start_s is None else start_s - pictures.span[0]
    (first, last), (begin, end) = track.span, (pictures.span[0] + shift, pictures.span[1] + shift)
    if unknown or end < first or begin > last:
        raise InputError(
            where, "time",
            f"poses from {tell_span(first, last)}, pictures ({pictures.whose}) from {tell_span(begin, end)}"
            + (", by clocks that cannot be compared" if unknown else ""),
            "--pictures-start-s T, the log's time of the first picture",
        )  # fmt: skip
    rows, omitted = list[Row](), set[float]()
    for place, values, names in pictures.rows(first - shift, last - shift, period_s):
        t = values["t"] + shift
        pose = track.at(t)
        if pose is None:
            omitted.add(t)
        else:
            rows.append((place, {**pose, **values, "t": t}, names))
    if not rows:
        raise InputError(
            where, "time", f"no poses near the pictures, which are from {tell_span(begin, end)}",
            "--pictures-start-s T, the log's time of the first picture",
        )  # fmt: skip
    found = placed_pictures(folder, pictures.source, rows, camera, perception, period_s)
    start = rows[0][1]["t"]
    at = None if track.in_degrees else track.place.at(start)
    clock = (
        f"{log.name}: first picture at {start:.1f} s of the log's clock, {start - first:.1f} s after its first position"
    )

    def keyframes(_: TimedPictures = pictures) -> Iterator[PosedFrame]:  # a video's pictures are there as long as these
        return found.keyframes()

    return replace(
        found,
        name=folder.resolve().name,
        keyframes=keyframes,
        datum=found.datum if at is None else (float(at[1, 3]), float(at[0, 3])),
        remarks=(clock, track.remark) if track.remark else (clock,),
        omitted=omitted,
    )
