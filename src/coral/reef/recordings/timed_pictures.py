"""Pictures of a dive with the times when they were taken: single files, or a video."""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from coral.errors import InputError
from coral.foreign_file import read_head, read_taken
from coral.limits import PICTURE_PIXELS, VIDEO_PICTURES, VIDEO_S
from coral.reef.recordings.picture_folder import EXIF_BYTES, Row, read_rows

TIMES = "times.csv"
PICTURES = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff")
VIDEOS = (".mp4", ".mov", ".mkv", ".avi", ".m4v", ".webm")
EXPECTED = f"a video, or pictures with {TIMES} (columns t, rgb), times in their names, or Exif"
_UNIX = re.compile(r"(?<![\d.])([1-9]\d{9})(\d{9}|\d{6}|\d{3})?(?!\d)(\.\d+(?=\.))?")
_CALENDAR = re.compile(r"(20\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)(\.\d{1,6}(?!\d))?(Z?)")
_CREATED = re.compile(r"creation_time\s*: (\S+)")
_SIZE = re.compile(r"Video: .*? (\d{2,5})x(\d{2,5})\b")
_LENGTH = re.compile(r"Duration: (\d+):(\d\d):(\d\d\.\d+)")
_RATE = re.compile(r" (\d+(?:\.\d+)?) (?:fps|tbr)")


@dataclass(frozen=True)
class TimedPictures:
    """Pictures with times."""

    source: Path
    """What the times come from, for errors."""
    span: tuple[float, float]
    """Time of the first and the last one (s)."""
    whose: str
    """What tells the times, for the user."""
    is_universal: bool
    """Whether the times may be compared with a log's; not those of an unknown time zone or from a video's beginning."""
    rows: Callable[[float, float, float], list[Row]]
    """Returns rows with t and rgb from a time, to a time, at least a period apart (s)."""


def find_pictures(folder: Path, size: tuple[int, int]) -> TimedPictures:
    """Find the pictures of a folder: `times.csv`, else a video, else picture files in it or one folder below.

    A video must have the camera's size (px).

    Raises:
        InputError: There are none, or their times are unknown.
    """
    if (folder / TIMES).is_file():
        return _listed(read_rows(folder / TIMES, ((),), "columns t, rgb"), folder / TIMES, TIMES, True)
    files = sorted([*folder.glob("*"), *folder.glob("*/*")])
    videos = [path for path in files if path.suffix.lower() in VIDEOS]
    pictures = [path for path in files if path.suffix.lower() in PICTURES]
    if len(videos) > 1 or (videos and pictures) or not (videos or pictures):
        names = ", ".join(path.name for path in videos[:3]) or "neither pictures nor a video"
        found = f"{names} and {len(pictures)} pictures" if videos and pictures else names
        raise InputError(str(folder), "", found, EXPECTED if not videos else "one video, or pictures")
    if videos:
        return _video(videos[0], size)
    times = [_time_in(path.stem + ".") for path in pictures]
    whose = "names"
    if None in times:
        times, whose = [_taken(path) for path in pictures], "Exif"
    if None in times:
        raise InputError(str(pictures[times.index(None)]), "", "no time, in its name or as Exif", EXPECTED)
    known = sorted(
        (time[0], str(path.relative_to(folder)), time[1]) for time, path in zip(times, pictures, strict=True) if time
    )
    rows = [(name, {"t": t}, {"rgb": name}) for t, name, _ in known]
    return _listed(rows, folder, whose, all(universal for _, _, universal in known))


def _listed(rows: list[Row], source: Path, whose: str, is_universal: bool) -> TimedPictures:
    span = rows[0][1]["t"], rows[-1][1]["t"]

    def between(begin: float, end: float, period_s: float) -> list[Row]:
        return rows

    return TimedPictures(source, span, whose, is_universal, between)


def _time_in(name: str) -> tuple[float, bool] | None:
    """Return the time that a name states, and whether it is universal time (s)."""
    if found := _UNIX.search(name):
        whole, part, decimals = found.groups()
        return int(whole) + (int(part) / 10.0 ** len(part) if part else float(decimals or 0.0)), True
    if found := _CALENDAR.search(name):
        *date, decimals, zone = found.groups()
        try:
            return datetime(*map(int, date), tzinfo=UTC).timestamp() + float(decimals or 0.0), zone == "Z"  # type: ignore[arg-type,misc]
        except ValueError:
            return None
    return None


def _taken(path: Path) -> tuple[float, bool] | None:
    """Return the time of a picture's Exif tags, and whether they tell its time zone (s)."""
    date, part, zone = read_taken(read_head(path, "a picture", EXIF_BYTES))
    for text, form in ((date + zone, "%Y:%m:%d %H:%M:%S%z"), (date + "+00:00", "%Y:%m:%d %H:%M:%S%z")):
        try:
            t = datetime.strptime(text, form).timestamp()
        except ValueError:
            continue
        return t + (float(f"0.{part}") if part.isdecimal() else 0.0), text == date + zone
    return None


def _video(path: Path, size: tuple[int, int]) -> TimedPictures:
    """Return the pictures of a video of a size (px).

    Its times count from its creation time, or from 0 if it has none.
    """
    read_head(path, "a video")
    told = _ffmpeg("-i", str(path))
    shape, length = _SIZE.search(told), _LENGTH.search(told)
    if shape is None or length is None:
        raise InputError(str(path), "", "no pictures", "a whole video that ffmpeg can read")
    width, height = map(int, shape.groups())
    if (width, height) != size or width * height > PICTURE_PIXELS:
        expected = f"{size[0]} x {size[1]}, the size of the camera"
        raise InputError(str(path), "", f"{width} x {height} pixels", expected)
    hours, minutes, seconds = map(float, length.groups())
    created, rate = _CREATED.search(told), _RATE.search(told)
    try:
        begin = datetime.fromisoformat(created[1]).timestamp() if created else 0.0
    except ValueError:
        begin = 0.0
    folder = tempfile.TemporaryDirectory(prefix="coral-video-")

    def between(start: float, end: float, period_s: float) -> list[Row]:
        step = max(period_s, 1.0 / max(float(rate[1]), 1.0) if rate else 0.0, 0.001)
        skipped, taken = max(0.0, start - begin), tempfile.mkdtemp(dir=folder.name)
        # `round=up` shows at each time the picture of that time, and none that came later.
        said = _ffmpeg(
            "-noautorotate", "-ss", f"{skipped:.6f}", "-i", str(path), "-t", f"{max(end - begin - skipped, step):.6f}",
            "-an", "-vf", f"fps={1.0 / step:.9f}:start_time=0:round=up", "-frames:v", str(VIDEO_PICTURES),
            "-q:v", "2", f"{taken}/%06d.jpg",
        )  # fmt: skip
        names = sorted(Path(taken).iterdir())
        if not names:
            found = said.strip().splitlines()[-1:] or ["none"]
            raise InputError(str(path), "pictures", found[0], "a video that ffmpeg can decode")
        after = [k * step + skipped for k in range(len(names))]
        return [(f"{t:.3f} s", {"t": begin + t}, {"rgb": str(name)}) for t, name in zip(after, names, strict=True)]

    whose = "creation time" if begin else "no creation time"
    return TimedPictures(path, (begin, begin + 3600 * hours + 60 * minutes + seconds), whose, begin > 0.0, between)


def _ffmpeg(*arguments: str) -> str:
    """Run ffmpeg on a file of this machine and return what it says; it opens nothing but files."""
    import imageio_ffmpeg

    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-nostdin", "-hide_banner", "-protocol_whitelist", "file", *arguments]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, errors="replace", check=False, timeout=VIDEO_S
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise InputError(
            arguments[arguments.index("-i") + 1], "", f"more than {VIDEO_S} s of work", "a video of a dive; cut it"
        ) from None
    return done.stderr
