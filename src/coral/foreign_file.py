"""The one opener of bytes that come from elsewhere: regular files only, bounded before they are unpacked or decoded.

A pipe could block the reader for ever, a device could deliver endless bytes, and a few kilobytes can unpack to
gigabytes. The bounds are those of `coral.limits`.
"""

from __future__ import annotations

import io
import json
import os
import sqlite3
import stat
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from coral import limits
from coral.errors import InputError, first_line

if TYPE_CHECKING:  # most commands read no arrays
    from numpy.typing import NDArray


class NotRegularError(OSError):
    """A file without an end, or one that waits for a writer."""

    def __init__(self, kind: str) -> None:
        super().__init__(kind)
        self.kind = kind


def open_regular(path: Path, *, follow: bool = True) -> BinaryIO:
    """Open a regular file for reading.

    Raises:
        NotRegularError: It is a pipe, a device or a socket.
        OSError: It cannot be read.
    """
    # Only this opens a pipe without a writer at once; for a regular file it has no effect.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags if follow else flags | getattr(os, "O_NOFOLLOW", 0))
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode):
        return open(descriptor, "rb")
    os.close(descriptor)
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(21, "Is a directory", str(path))
    raise NotRegularError("a named pipe" if stat.S_ISFIFO(mode) else "a device")


def regular_bytes(path: Path, most_bytes: int) -> bytes:
    """Read a regular file, at most one byte more than `most_bytes`.

    Raises:
        NotRegularError: It is a pipe, a device or a socket.
        OSError: It cannot be read.
    """
    with open_regular(path) as file:
        # `read` takes the memory that it is asked for, however small the file.
        size = os.fstat(file.fileno()).st_size
        return file.read(min(size, most_bytes) + 1)


def read_bytes(path: Path, expected: str, most_bytes: int, field: str = "") -> bytes:
    """Read a regular file of at most `most_bytes`; links are followed.

    `expected` is the kind of file and `field` what names it, for the message.

    Raises:
        InputError: It is missing, a folder, not a regular file, unreadable, or too large.
    """
    with _saying_why(path, expected, field), open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
        content = file.read(size + 1) if size <= most_bytes else b""
    if max(size, len(content)) > most_bytes:
        shown = f"{most_bytes / 1e6:.0f} MB"
        raise InputError(str(path), field, f"more than {shown}", f"a file of at most {shown}")
    return content


def read_head(path: Path, expected: str, most_bytes: int = 16) -> bytes:
    """Read the first bytes of a regular file of any size; for files that a library opens itself.

    Raises:
        InputError: It is missing, a folder, not a regular file, or unreadable.
    """
    with _saying_why(path, expected), open_regular(path) as file:
        return file.read(most_bytes)


@contextmanager
def _saying_why(path: Path, expected: str, field: str = "") -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise InputError(str(path), field, "no such file", expected) from None
    except IsADirectoryError:
        raise InputError(str(path), field, "a folder", expected) from None
    except NotRegularError as error:
        raise InputError(str(path), field, error.kind, f"a regular file: {expected}") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(str(path), field, reason.lower(), expected) from None


def read_text(path: Path, expected: str, most_bytes: int = limits.YAML_BYTES, field: str = "") -> str:
    """Read the UTF-8 text of a regular file, without the mark that some programs put before it. See `read_bytes`.

    Raises:
        InputError: As `read_bytes`, or it is not UTF-8.
    """
    content = read_bytes(path, expected, most_bytes, field)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(str(path), field, "bytes that are not UTF-8 text", expected) from None


def parse_json(text: str | bytes, constant: Callable[[str], Any] | None = None) -> Any:
    """Parse JSON that is not nested deeper than Python's functions can follow.

    `constant` makes something of NaN and infinities, which JSON has not; by default they are floats.

    Raises:
        ValueError: It is not JSON, or nested too deeply.
    """
    with suppress(RecursionError):
        value = json.loads(text, parse_constant=constant)
        if not is_deep(value):
            return value
    raise ValueError(f"values nested more than {limits.JSON_DEPTH} deep")


def is_deep(value: Any, depth: int = limits.JSON_DEPTH) -> bool:
    """Check whether lists and mappings are nested more than `depth` deep."""
    if not isinstance(value, dict | list):
        return False
    if depth == 0:
        return True
    return any(is_deep(item, depth - 1) for item in (value.values() if isinstance(value, dict) else value))


def read_json(path: Path, expected: str, most_bytes: int = limits.JSON_BYTES) -> Any:
    """Read a JSON file.

    Raises:
        InputError: As `read_text`, or it is not JSON, or nested too deeply.
    """
    text = read_text(path, expected, most_bytes)
    try:
        return parse_json(text)
    except ValueError as error:
        raise InputError(str(path), "", f"broken JSON ({first_line(error)})", expected) from None


def read_log_lines(path: Path, most_chars: int = limits.LOG_BYTES) -> Iterator[str]:
    """Read the lines of a text file, with their ends.

    Raises:
        InputError: It is no regular file, or longer than `most_chars`; or a line is longer than any.
    """
    try:
        with open_regular(path) as raw:
            file = io.TextIOWrapper(raw, encoding="utf-8", errors="replace")
            total = 0
            while line := file.readline(limits.LINE_CHARS + 1):
                total += len(line)
                for what, chars, most in (("a line", len(line), limits.LINE_CHARS), ("a log", total, most_chars)):
                    if chars > most:
                        raise InputError(str(path), "", f"{what} of more than {most} characters", "the log of a run")
                yield line
    except NotRegularError as error:
        raise InputError(str(path), "", error.kind, "a regular file: the log of a run") from None
    except FileNotFoundError:
        raise
    except OSError as error:
        raise InputError(str(path), "", error.strerror or first_line(error), "the log of a run") from None


def picture_size(content: bytes) -> tuple[int, int] | None:
    """Return width and height that a picture file states, without decoding it; None if it is no picture."""
    if content[:8] == b"\x89PNG\r\n\x1a\n" and len(content) >= 24:
        width, height = struct.unpack(">II", content[16:24])
        return int(width), int(height)
    from PIL import Image

    try:
        with warnings.catch_warnings():  # about damaged tags, which are not asked for
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(content), formats=("JPEG", "WEBP", "TIFF", "BMP", "PNG")) as found:
                return found.size
    except Image.DecompressionBombError:
        return limits.PICTURE_PIXELS, limits.PICTURE_PIXELS
    except Exception:  # its plugins raise all kinds
        return None


def read_taken(content: bytes) -> tuple[str, str, str]:
    """Return when a picture was taken by its Exif tags: DateTimeOriginal, SubSecTimeOriginal, OffsetTimeOriginal.

    The beginning of the file is enough. Tags that it has not are "".
    """
    tags = _exif(content, 0x8769)
    date, part, zone = (str(tags.get(tag, "")).strip(" \0") for tag in (0x9003, 0x9291, 0x9011))
    return date, part, zone


def read_orientation(content: bytes) -> int:
    """Return how a picture should be turned by its Exif tag Orientation, 1 to 8; 1, as it lies, where it has none.

    The beginning of the file is enough.
    """
    turned = _exif(content).get(0x0112, 1)
    return int(turned) if turned in range(1, 9) else 1


def _exif(content: bytes, directory: int | None = None) -> dict[int, Any]:
    """Return the Exif tags of a picture, or those of a directory in it; none where they are damaged."""
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(content), formats=("JPEG", "WEBP", "TIFF", "PNG")) as found:
                tags = found.getexif()
                return dict(tags if directory is None else tags.get_ifd(directory))
    except Exception:  # its plugins raise all kinds
        return {}


def decode_picture(content: bytes, mode: int | None = None) -> NDArray[Any] | None:
    """Decode a PNG, JPEG, WebP, TIFF or BMP picture in one of OpenCV's modes, by default as stored; None if it is none.

    Raises:
        ValueError: It has more pixels than any camera's.
    """
    import cv2
    import numpy as np

    size = picture_size(content)
    if size is None:
        return None
    if size[0] * size[1] > limits.PICTURE_PIXELS:
        shown = f"{size[0]} x {size[1]} pixels" if size[0] < limits.PICTURE_PIXELS else "too many pixels"
        raise ValueError(f"{shown}, where {limits.PICTURE_PIXELS / 1e6:.0f} million are the most")
    try:
        found = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED if mode is None else mode)
    except cv2.error:
        return None
    return None if found is None else np.asarray(found)


def read_picture_file(path: Path, mode: int | None = None, *, channels: int | None = None) -> NDArray[Any] | None:
    """Read a picture file; None if it is missing, or no picture that may be decoded. See `decode_picture`.

    A picture with another number of `channels` counts as none: a map with colours has no classes.
    """
    try:
        content = regular_bytes(path, limits.PICTURE_BYTES)
        found = decode_picture(content, mode) if len(content) <= limits.PICTURE_BYTES else None
    except (OSError, ValueError):
        return None
    fits = found is None or channels is None or channels == (1 if found.ndim == 2 else found.shape[2])
    return found if fits else None


def read_arrays(source: Path | bytes) -> dict[str, NDArray[Any]]:
    """Read the arrays of an .npz file, as large as each says before it is unpacked.

    Raises:
        ValueError: It is no such file, or its arrays are too large.
        OSError: It cannot be read.
    """
    try:
        content = source if isinstance(source, bytes) else regular_bytes(source, limits.ARRAYS_BYTES)
        if len(content) > limits.ARRAYS_BYTES:
            raise ValueError(f"more than {limits.ARRAYS_BYTES / 1e6:.0f} MB")
        archive = zipfile.ZipFile(io.BytesIO(content))
        if sum(member.file_size for member in archive.infolist()) > limits.ARRAYS_BYTES:
            raise ValueError(f"more than {limits.ARRAYS_BYTES / 1e6:.0f} MB when unpacked")
        with archive:
            return {
                name.removesuffix(".npy"): _array(archive.read(name), name)
                for name in archive.namelist()
                if name.endswith(".npy")
            }
    except (zipfile.BadZipFile, zlib.error, KeyError, EOFError, NotImplementedError, RuntimeError) as error:
        raise ValueError(f"no whole .npz file ({first_line(error)})") from None


def _array(content: bytes, name: str) -> NDArray[Any]:
    from numpy.lib import format as npy

    try:
        return npy.read_array(io.BytesIO(content), allow_pickle=False)
    except (ValueError, TypeError, KeyError, SyntaxError, MemoryError, RecursionError) as error:
        raise ValueError(f"{name}: no array ({first_line(error)})") from None


@contextmanager
def open_sqlite(path: Path, busy_s: float = 5.0) -> Iterator[sqlite3.Connection]:
    """Open an SQLite file so that no value in it is larger than `limits.ROW_BYTES`, and its schema runs no functions.

    Raises:
        NotRegularError: It is a pipe or a device.
        sqlite3.Error: It is no such file.
    """
    if path.exists():
        open_regular(path).close()
    with closing(sqlite3.connect(path, timeout=busy_s)) as base:
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, limits.ROW_BYTES)
        base.execute("PRAGMA trusted_schema = OFF")
        yield base


def check_tables(path: Path, *names: str) -> None:
    """Check that an SQLite file has tables, no views, whose columns hold what is in the file and compute nothing.

    Raises:
        InputError: It does not.
    """
    try:
        with open_sqlite(path) as base:
            refuse_computed(base, str(path), *names)
    except (sqlite3.Error, OSError) as error:
        raise InputError(str(path), "", getattr(error, "strerror", None) or error, "an SQLite file") from None


def refuse_computed(base: sqlite3.Connection, where: str, *names: str) -> None:
    """Refuse a view or a generated column in place of a table that was written, as in `check_tables`.

    Raises:
        InputError: There is one.
    """
    for name in names:
        found = base.execute("SELECT type FROM sqlite_master WHERE name = ?", (name,)).fetchone()
        if found is not None and found[0] != "table":
            raise InputError(where, name, f"a {found[0]}", "a table")
        for column in base.execute("SELECT name, hidden FROM pragma_table_xinfo(?)", (name,)).fetchall():
            if column[1]:
                raise InputError(where, f"{name}.{column[0]}", "a generated column", "a column of stored values")
