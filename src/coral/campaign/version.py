"""What must be equal for results to be compared: the version of the code, and digests of other conditions."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

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


def digest(content: Any) -> str:
    """Compute twelve hexadecimal digits that identify contents."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()[:12]
