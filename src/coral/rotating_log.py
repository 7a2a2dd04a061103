"""A log that is cut into parts: the present one grows, those before it are packed, and all are read as one."""

from __future__ import annotations

import gzip
import os
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

from coral.errors import naming
from coral.file_writer import open_log, scratch_for
from coral.foreign_file import open_regular, read_log_lines

MOST_BYTES = 64_000_000
"""A part that has grown to this size is packed, to about a tenth of it. Missions in simulation never reach it."""


class RotatingLog:
    """Appends lines to a file. What is full is renamed to NAME.0001.SUFFIX and packed; a kill loses no line."""

    def __init__(self, path: Path, header: str = "", most_bytes: int = MOST_BYTES) -> None:
        """Create the file, which must not exist yet.

        Args:
            path: The file that grows.
            header: First line of every part; "" for none.
            most_bytes: Size at which a part is full.

        Raises:
            OSError: It cannot be created.
        """
        self._path, self._header, self._most = path, header, most_bytes
        self._parts = 0
        self._open()

    def append(self, line: str) -> None:
        """Append a line, and flush it.

        Raises:
            OSError: It cannot be written; the error names the file.
        """
        with naming(self._path):
            if self._size >= self._most:
                self._rotate()
            self._log.write(line + "\n")
            self._size += len(line) + 1

    def close(self) -> None:
        """Close the file."""
        self._log.close()

    def _open(self) -> None:
        self._log: IO[str] = open_log(self._path)
        self._size = 0
        if self._header:
            self._log.write(self._header + "\n")

    def _rotate(self) -> None:
        self._log.close()
        self._parts += 1
        full = self._path.with_name(f"{self._path.stem}.{self._parts:04d}{self._path.suffix}")
        os.rename(self._path, full)
        self._open()
        try:
            with (
                scratch_for(Path(f"{full}.gz")) as packed,
                open_regular(full) as plain,
                gzip.open(packed, "wb", compresslevel=5) as out,
            ):
                shutil.copyfileobj(plain, out)
        except OSError:  # no room to pack it: the part stays as it is
            return
        full.unlink()


def earlier_parts(path: Path) -> list[Path]:
    """Return the full parts of a log, oldest first; one that was killed while it was packed is there once."""
    pattern = re.compile(rf"{re.escape(path.stem)}\.(\d{{4,}}){re.escape(path.suffix)}(\.gz)?")
    found: dict[int, Path] = {}
    for other in sorted(path.parent.iterdir()) if path.parent.is_dir() else ():
        match = pattern.fullmatch(other.name)
        if match is not None and (match[2] is None or int(match[1]) not in found):
            found[int(match[1])] = other
    return [found[number] for number in sorted(found)]


def read_lines(path: Path, *, headed: bool = False) -> Iterator[str]:
    """Read a log as one, with its line ends.

    Args:
        path: The file that grows, or grew last.
        headed: Whether every part begins with the same header line; it is returned once.
    """
    return read_parts([*earlier_parts(path), path], headed=headed)


def read_parts(parts: Sequence[Path], *, headed: bool = False) -> Iterator[str]:
    """Read some parts of a log, as `read_lines` does."""
    for k, part in enumerate(parts):
        lines = read_log_lines(part)
        if headed and k:
            next(lines, None)
        yield from lines
