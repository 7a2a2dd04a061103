"""The code version of an episode, computed from the files themselves, with or without a repository."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from coral.foreign_file import read_bytes
from coral.limits import YAML_BYTES

PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = {".py", ".yaml", ".json", ".md", ".xml"}
_ONLY_LOOKED_AT = {"campaign", "commands", "desk", "view"}
"""Parts of the package that only show or distribute results."""


@cache
def code_version() -> str:
    """Compute a digest of every file of the package that can change the result of an episode.

    Unlike a commit it also distinguishes edited files, and is unaffected by changes of tables or pages.
    """
    total = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*")):
        inside = path.relative_to(PACKAGE)
        if path.suffix in _SOURCES and inside.parts[0] not in _ONLY_LOOKED_AT and path.is_file():
            total.update(f"{inside.as_posix()}\0".encode())
            total.update(hashlib.sha256(read_bytes(path, "a module", YAML_BYTES)).digest())
    return total.hexdigest()[:12]
