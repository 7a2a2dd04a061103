"""The one writer of files: whole or not at all, and never through a link that somebody planted.

A file is made under a name that nobody can guess, which must be new, and renamed into its place. A rename replaces a
link, it does not follow it. Logs that grow are opened under names that must be new as well.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from coral.errors import InputError, naming

PRIVATE = 0o700
"""Mode of folders whose content is nobody else's business: runs, inboxes, caches."""
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


def write_whole(path: Path, content: bytes | str, *, durable: bool = False, replace: bool = True) -> None:
    """Write a file atomically, and its folder if that is missing; text becomes UTF-8.

    A durable file is whole even if the machine loses power, which takes milliseconds more.

    Raises:
        FileExistsError: It exists and is not to be replaced.
        OSError: The file cannot be written, or is a device or a pipe; the error names it.
    """
    with naming(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_name(f".{path.name[:100]}.{secrets.token_hex(8)}.part")
        try:
            with open(os.open(unfinished, _NEW, 0o666), "wb") as out:
                out.write(content.encode() if isinstance(content, str) else content)
                if durable:
                    out.flush()
                    os.fsync(out.fileno())
            _put(unfinished, path, replace)
            if durable:
                _sync_folder(path.parent)
        finally:
            with contextlib.suppress(OSError):
                unfinished.unlink()


@contextlib.contextmanager
def scratch_for(path: Path) -> Iterator[Path]:
    """Let a library write a file or a folder that appears at `path` whole.

    The library gets a free path of the same name in a private folder beside it. What lies there when the block ends is
    moved to `path`; after an error it is removed.

    Raises:
        OSError: It cannot be written, or is a device or a pipe; the error names it.
    """
    with naming(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".", suffix=".part") as folder:
            scratch = Path(folder) / path.name
            yield scratch
            _put(scratch, path, replace=True)


def open_log(path: Path, *, new: bool = True) -> IO[str]:
    """Open a file to which lines are appended, each flushed.

    Raises:
        OSError: It exists and must not, is a link, or cannot be written.
    """
    flags = (_NEW if new else _NEW & ~os.O_EXCL) | os.O_APPEND

    def opener(name: str, _: int) -> int:
        return os.open(name, flags, 0o666)

    return open(path, "a", encoding="utf-8", newline="\n", buffering=1, opener=opener)


@contextlib.contextmanager
def writing(where: Path | str, field: str = "", expected: str = "a file that can be written") -> Iterator[None]:
    """Say in one line why something cannot be written. The arguments are those of `InputError`.

    Raises:
        InputError: The block raised an OSError.
    """
    try:
        yield
    except OSError as error:
        raise InputError(str(where), field, error.strerror or error, expected) from None


def _put(made: Path, path: Path, replace: bool) -> None:
    with contextlib.suppress(FileNotFoundError):
        mode = path.stat().st_mode
        if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
            raise OSError(22, "a device or a pipe", str(path))
    if replace:
        os.replace(made, path)
        return
    try:
        os.link(made, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links: a claim that only one process can create
        os.close(os.open(path.with_name(f"{path.stem}.claim"), _NEW, 0o600))
        if path.exists():
            raise FileExistsError(17, "it exists", str(path)) from None
        os.replace(made, path)


def _sync_folder(folder: Path) -> None:
    """Make a rename last through a power cut, where the system can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
