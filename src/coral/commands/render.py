"""What a run writes for people after its end, where the wing that makes it is installed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coral.errors import InputError
from coral.plugins import our_part
from coral.terminal import tell


def render(folder: Path, *, report: bool, video: bool) -> dict[str, str]:
    """Make report, with its pictures, and video of a finished run; a missing wing is told in a line."""
    if not report and not video:
        return {}
    try:
        write = our_part("rendering", "run", "report")
    except InputError as error:
        tell(error)
        return {}
    made: dict[str, str] = write(folder, report=report, video=video)
    return made


def list_made(result: Mapping[str, Any]) -> list[str]:
    """Return a line for each file that people open, and one about who decided."""
    lines = [f"{name}: {result[name]}" for name in ("report", "video") if result.get(name)]
    return [*lines, *([str(result["decided"])] if result.get("decided") else [])]
