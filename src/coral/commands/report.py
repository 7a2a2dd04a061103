"""`coral report`: make the report of a run folder again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.flags import Argument
from coral.run_files import SurveyFiles, TaskFiles
from coral.view.rendering import render_run


@dataclass(frozen=True, kw_only=True)
class Report:
    """Write report.html and its pictures (map.png or keyframes.png) of a run folder again, also of a killed run."""

    run: Annotated[Path, Argument(metavar="RUN")]
    """Run folder."""
    video: bool = False
    """Also write the video, mission.mp4 or episode.mp4."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        made = render_run(self.run, report=True, video=self.video)
        pictures = {"map": self.run / SurveyFiles.MAP, "keyframes": self.run / TaskFiles.KEYFRAMES}
        return {**made, **{name: str(path) for name, path in pictures.items() if path.is_file()}}

    def describe(self, result: Mapping[str, Any]) -> str:
        return "\n".join(f"{name}: {path}" for name, path in result.items())
