"""Commands and configurations as data without importing them, from a cache that is made again when the code changed.

To describe a command its module must be imported, with all that it needs: seconds. Help, completion, a mistyped flag
and `coral config` need the description alone.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Any

from coral.errors import MALFORMED
from coral.flags import Described, Flag, FlagGroup, describe

PACKAGE = Path(__file__).parent


def load(place: str) -> Any:
    """Import what `module:name` names."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def described(place: str) -> Described:
    """Describe the command or configuration at `module:class`."""
    path, code = _cache() / f"{place.replace(':', '.')}.json", _code()
    with suppress(OSError, *MALFORMED):
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["code"] == code:
            return _read(content["described"])
    found = describe(load(place))
    with suppress(OSError):  # a home that cannot be written
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}.part")
        part.write_text(json.dumps({"code": code, "described": asdict(found)}), encoding="utf-8")
        os.replace(part, path)
    return found


def _read(content: Any) -> Described:
    def flag(values: Any) -> Flag:
        return Flag(**{**values, "field": tuple(values["field"]), "names": tuple(values["names"])})

    return Described(
        text=content["text"],
        flags=tuple(map(flag, content["flags"])),
        groups=tuple(FlagGroup(**group) for group in content["groups"]),
    )


def _cache() -> Path:
    """Return the folder of this installation's descriptions."""
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "coral" / "flags" / hashlib.sha256(str(PACKAGE).encode()).hexdigest()[:12]


def _code() -> str:
    """Return a fingerprint of the package's files, and of the folders where other packages are installed."""
    places = [f"{place}:{os.stat(place).st_mtime_ns}" for place in sys.path if place and os.path.isdir(place)]
    return hashlib.sha256("\n".join([*_stamps(PACKAGE), *places]).encode()).hexdigest()


def _stamps(folder: str | Path) -> Iterator[str]:
    with os.scandir(folder) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if entry.is_dir(follow_symlinks=False):
                yield from () if entry.name == "__pycache__" else _stamps(entry.path)
            else:
                seen = entry.stat()
                yield f"{entry.path}:{seen.st_mtime_ns}:{seen.st_size}"
