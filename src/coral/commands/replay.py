"""`coral replay`: a recorded run on the live page."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

from coral.config import Positive, checked
from coral.flags import Argument


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
        """Serve until interrupted."""
        from coral.view.live.pace import Pace
        from coral.view.live.page import LivePage
        from coral.view.live.panel import ReplayControls
        from coral.view.live.recorded import Player, RecordedRun
        from coral.view.live.recorded_task import RecordedTask
        from coral.view.run import RunFolder

        checked(self, "coral replay")
        found = RunFolder.read(self.run)
        recording = RecordedTask(found) if (self.run / "task.yaml").is_file() else RecordedRun(found)
        pace = Pace(self.speed)
        player = Player(recording, pace)
        controls = ReplayControls(pace, recording.duration_s, player.seek, player.play)
        with LivePage(self.port, controls, label="CORAL replay") as page:
            before = signal.signal(signal.SIGTERM, _interrupt)
            try:
                print(f"watch the run at {page.url}; Ctrl-C closes it", file=sys.stderr, flush=True)
                for note in found.notes:
                    print(f"note: {note}", file=sys.stderr, flush=True)
                player.run(page, time.monotonic, threading.Event().wait)
            except KeyboardInterrupt:
                pass
            finally:
                signal.signal(signal.SIGTERM, before)
            return {
                "run": str(self.run),
                "url": page.url,
                "duration_s": recording.duration_s,
                "complete": found.complete,
            }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe what was shown."""
        return f"the page is closed; {result['duration_s']:.0f} s of {result['run']} could be watched"


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
