"""Progress bars of missions and episodes, on standard error."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from coral.odd_text import printable
from coral.words import many

if TYPE_CHECKING:  # a command loads the system that it runs, not the other one
    from coral.reef.mission.mission import Mission


class RunBar:
    """A bar of simulated time with a status line and the speed relative to real time."""

    def __init__(self, *, quiet: bool = False) -> None:
        self._bar = Progress(
            TextColumn("{task.description}", style="bold", markup=False),
            BarColumn(bar_width=12),
            TextColumn("{task.fields[status]}", markup=False),
            console=Console(stderr=True),
            transient=False,
            disable=quiet,
            refresh_per_second=5,
        )
        self._task = self._bar.add_task("", total=1.0, status="")
        self._started = time.monotonic()
        self._bar.start()

    def show(self, name: str, t: float, time_limit_s: float, status: str) -> None:
        """Update the bar of a world or a task at a simulated time (s); the bar is full at `time_limit_s`."""
        factor = t / max(time.monotonic() - self._started, 1e-3)
        speed = f"{factor:.0f}x" if factor >= 10 else f"{factor:.2g}x"
        self._bar.update(
            self._task,
            description=printable(name),
            completed=t,
            total=time_limit_s,
            status=f"{t:.0f} s simulated · {status} · {speed}",
        )

    def stop_requested(self) -> str:
        """Return "": a progress bar never stops a run."""
        return ""

    def close(self) -> None:
        """Keep the last state on the screen."""
        self._bar.stop()


class MissionProgress(RunBar):
    """The bar of a mission: coverage, collisions, advisor calls."""

    def tick(self, mission: Mission) -> None:
        """Update the bar, once per simulated second at most."""
        if mission.step % 10 and not mission.end_reason:
            return
        status = (
            f"{100 * mission.coverage:.0f} % covered · {many(mission.collisions, 'collision')} · "
            f"{many(mission.calls, 'call')}"
        )
        self.show(mission.world.name, mission.t, mission.cfg.time_limit_s, status)


class EpisodeProgress(RunBar):
    """The bar of a contact episode: its stage, and how many conditions hold."""

    def tick(self, episode: Any) -> None:
        """Update the bar of an episode with a planner, or with a served policy."""
        holding = episode.referee.holding
        conditions = f" · {sum(holding)} of {len(holding)} conditions" if holding else ""
        status = f"{printable(episode.stage, 30)}{conditions}"
        self.show(episode.trial.task.name, episode.t, episode.time_limit_s, status)
