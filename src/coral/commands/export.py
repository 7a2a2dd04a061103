"""`coral export`: a survey for other tools."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.errors import InputError
from coral.flags import Argument, Option
from coral.plugins import named_plugin
from coral.reef.recordings.run_recording import read_run
from coral.run_files import TaskFiles
from coral.words import many

SUFFIX = {"bag": "_bag", "mcap": ".mcap", "pictures": "_pictures"}


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write a survey as messages of ROS 2, following REP-103 and REP-105, or as pictures.

    It becomes pictures, odometry, transforms, maps and points.
    """

    run: Annotated[Path, Argument(metavar="RUN")]
    """Run folder of a mission."""
    to: Annotated[str, Option(names=("mcap", "bag", "pictures"))] = "mcap"
    """mcap: one file, for Foxglove and others. bag: a ROS 2 bag, a folder. pictures: a
    folder of colour pictures with their poses, and nothing else. Or an entry point of the group coral.exporters."""
    out: Path | None = None
    """What to write; it must not exist. By default RUN/RUN.mcap, RUN/RUN_bag and so on."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        if (self.run / TaskFiles.TASK).is_file():
            instead = "a survey; `coral contact export` writes contact runs as LeRobot sets"
            raise InputError(str(self.run), "", "a contact run", instead)
        write = named_plugin("coral.exporters", self.to, "--to")
        out = self.out or self.run / f"{self.run.resolve().name}{SUFFIX.get(self.to, f'_{self.to}')}"
        if out.exists():
            raise InputError(str(out), "--out", "something that exists already", "a new path")
        counts = write(read_run(self.run).located(), out)
        size = out.stat().st_size if out.is_file() else sum(p.stat().st_size for p in out.rglob("*") if p.is_file())
        return {"export": str(out), "messages": counts, "bytes": size}

    def describe(self, result: Mapping[str, Any]) -> str:
        total, topics = sum(result["messages"].values()), len(result["messages"])
        return (
            f"{result['export']}: {many(total, 'message')} on {many(topics, 'topic')}, {result['bytes'] / 1e6:.1f} MB"
        )
