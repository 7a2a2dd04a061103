"""What a run writes for people after its end, where the wing that makes it is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from coral.errors import InputError
from coral.plugins import our_part
from coral.terminal import tell


class Rendered(Protocol):
    """What the configuration of a record says of it."""

    @property
    def report(self) -> bool: ...
    @property
    def video(self) -> bool: ...


def render(folder: Path, record: Rendered) -> dict[str, str]:
    """Make pictures, report and video of a finished run, as configured; a missing wing is told in a line."""
    if not record.report and not record.video:
        return {}
    try:
        write = our_part("rendering", "run", "report")
    except InputError as error:
        tell(error)
        return {}
    made: dict[str, str] = write(folder, report=record.report, video=record.video)
    return made
