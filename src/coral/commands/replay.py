"""`coral replay` and `coral report`: a recorded run on the live page, or its report made again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.config import Positive, checked
from coral.flags import Argument
from coral.interrupts import wait_for_interrupt
from coral.run_files import SurveyFiles, TaskFiles
from coral.terminal import tell
from coral.view.rendering import render_run


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Show a run folder again in a browser, also that of a killed run; Ctrl-C ends it."""

    run: Annotated[Path, Argument(metavar="RUN")]
    """Run folder."""
    port: int = 8080
    """Port of the page on this machine; 0 chooses a free one."""
    speed: Positive = 10.0
    """Initial speed, in multiples of real time."""
    json: bool = False
    """Print one JSON object at the end; the address goes to standard error."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.view.live.viewer import Viewer
        from coral.view.run import RunFolder

        checked(self, "coral replay")
        found = RunFolder.read(self.run)
        viewer = Viewer(self.run, rate=self.speed, port=self.port)
        viewer.stream.subject  # noqa: B018  # tells what is wrong before the page opens
        with viewer as page:
            tell(f"watch the run at {page.url}; Ctrl-C closes it")
            for note in found.notes:
                tell(f"note: {note}")
            wait_for_interrupt()
            return {"run": str(self.run), "url": page.url, "duration_s": found.duration_s, "complete": found.complete}

    def describe(self, result: Mapping[str, Any]) -> str:
        return f"the page is closed; {result['duration_s']:.0f} s of {result['run']} could be watched"


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
