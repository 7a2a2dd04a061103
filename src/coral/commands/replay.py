"""`coral replay`: a recorded run on the live page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.config import Positive, checked
from coral.flags import Argument
from coral.interrupts import wait_for_interrupt
from coral.terminal import tell


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
