"""`coral report`: make the report of a run folder again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.flags import Argument


@dataclass(frozen=True, kw_only=True)
class Report:
    """Write report.html and its pictures (map.png or keyframes.png) of a run folder again, also of a killed run."""

    run: Annotated[Path, Argument(metavar="RUN")]
    """Run folder."""
    video: bool = False
    """Also write the film, mission.mp4 or episode.mp4."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Write the files."""
        if (self.run / "task.yaml").is_file():
            return self._contact()
        from coral.view.report import write_report
        from coral.view.runmap import write_map

        made = {"report": str(write_report(self.run)), "map": str(write_map(self.run))}
        if self.video:
            from coral.view.video import write_video

            made["video"] = str(write_video(self.run))
        return made

    def _contact(self) -> Mapping[str, Any]:
        from coral.view.contact.report import write_contact_report

        made = {}
        if self.video:
            from coral.view.contact.video import write_contact_video

            made["video"] = str(write_contact_video(self.run))
        made["report"] = str(write_contact_report(self.run))
        if (self.run / "keyframes.png").is_file():
            made["keyframes"] = str(self.run / "keyframes.png")
        return made

    def describe(self, result: Mapping[str, Any]) -> str:
        """List the files."""
        return "\n".join(f"{name}: {path}" for name, path in result.items())
