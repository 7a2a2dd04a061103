"""What takes long to compute, kept as JSON in the user's cache folder until what it depends on changes."""

from __future__ import annotations

import hashlib
import json
import os
import sysconfig
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from coral.errors import MALFORMED
from coral.file_writer import PRIVATE, write_whole
from coral.foreign_file import read_json

PACKAGE = Path(__file__).parent


def recall(name: str, key: str, make: Callable[[], Any]) -> Any:
    """Return the value kept under a name for this key, or make and keep it: plain values, as JSON has them.

    The key is everything that the value depends on; a value replaces the one of another key.
    """
    installed = hashlib.sha256(str(PACKAGE).encode()).hexdigest()[:12]
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    path = Path(root) / "coral" / installed / f"{name}.json"
    with suppress(OSError, *MALFORMED):
        content = read_json(path, "a cached value")
        if content["key"] == key:
            return content["value"]
    value = make()
    with suppress(OSError):  # a home that cannot be written
        path.parent.mkdir(PRIVATE, parents=True, exist_ok=True)
        write_whole(path, json.dumps({"key": key, "value": value}))
    return value


def code_stamp() -> str:
    """Return a text that changes with every file of the package, and with what else is installed."""
    installed = [f"{folder}:{os.stat(folder).st_mtime_ns}" for folder in _site_packages()]
    return hashlib.sha256("\n".join([*_stamps(PACKAGE), *installed]).encode()).hexdigest()


def _site_packages() -> set[str]:
    return {sysconfig.get_path(kind) for kind in ("purelib", "platlib")}


def _stamps(folder: str | Path) -> Iterator[str]:
    with os.scandir(folder) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if entry.is_dir(follow_symlinks=False):
                yield from () if entry.name == "__pycache__" else _stamps(entry.path)
            else:
                seen = entry.stat()
                yield f"{entry.path}:{seen.st_mtime_ns}:{seen.st_size}"
