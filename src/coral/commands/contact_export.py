"""`coral contact export`: finished runs as a data set for learners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from coral.config import checked
from coral.errors import InputError
from coral.flags import Argument
from coral.view.contact.lerobot import LerobotCfg, write_lerobot
from coral.view.run import RunFolder
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class ContactExport:
    """Write finished runs of contact tasks as a data set for learners: one episode for each run."""

    runs: Annotated[tuple[Path, ...], Argument(metavar="RUN...")]
    """Run folders of `coral contact run`, or of the episodes of a campaign."""
    out: Path
    """Folder of the data set, new or empty."""
    to: Literal["lerobot"] = "lerobot"
    """Format: lerobot, LeRobot's data sets of version 3."""
    successes: bool = False
    """Leave out runs that did not succeed."""
    json: bool = False
    """Print one JSON object."""
    cfg: LerobotCfg = field(default_factory=LerobotCfg)
    """Rate and pictures."""

    def __call__(self) -> Mapping[str, Any]:
        runs = [path for path in self.runs if not self.successes or RunFolder.read(path).metrics.get("success")]
        if self.runs and not runs:
            raise InputError("--successes", "", f"none among {many(len(self.runs), 'run')}", "at least one success")
        return write_lerobot(runs, self.out, checked(self.cfg, "--cfg"))

    def describe(self, result: Mapping[str, Any]) -> str:
        successes = many(result["successes"], "success", "successes")
        episodes, frames = many(result["episodes"], "episode"), many(result["frames"], "frame")
        return f"{result['dataset']}: {episodes}, {successes}, {frames}"
