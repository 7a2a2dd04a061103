"""The progress bar of a reef mission, on standard error."""

from __future__ import annotations

import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from coral.odd_text import printable
from coral.reef.mission import Mission


class MissionProgress:
    """Shows simulated time, coverage, collisions, advisor calls and speed relative to real time."""

    def __init__(self, *, quiet: bool = False) -> None:
        self._bar = Progress(
            TextColumn("{task.description}", style="bold", markup=False),
            BarColumn(bar_width=24),
            TextColumn("{task.fields[status]}", markup=False),
            console=Console(stderr=True),
            transient=False,
            disable=quiet,
            refresh_per_second=5,
        )
        self._task = self._bar.add_task("", total=1.0, status="")
        self._started = time.monotonic()
        self._bar.start()

    def tick(self, mission: Mission) -> None:
        """Bring the bar up to date, ten times a simulated second at most."""
        if mission.step % 10 and not mission.end_reason:
            return
        factor = mission.t / max(time.monotonic() - self._started, 1e-3)
        self._bar.update(
            self._task,
            description=printable(mission.world.name),
            completed=mission.t,
            total=mission.cfg.time_limit_s,
            status=f"{mission.t:5.0f} s simulated · coverage {100 * mission.coverage:3.0f} % · "
            f"{mission.collisions} collisions · {mission.calls} advisor calls · {factor:.0f}x real time",
        )

    def stop_requested(self) -> str:
        """A progress bar never stops a mission."""
        return ""

    def close(self) -> None:
        """Leave the last state on the screen."""
        self._bar.stop()
