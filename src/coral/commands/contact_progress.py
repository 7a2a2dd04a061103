"""The progress bar of a contact episode, on standard error."""

from __future__ import annotations

import time
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from coral.contact.scene.judge import Judge
from coral.contact.scene.trial import Trial
from coral.odd_text import printable


class Running(Protocol):
    """An episode, driven by a planner or by a served policy, as far as the bar looks at it."""

    t: float
    time_limit_s: float
    trial: Trial
    judge: Judge

    @property
    def stage(self) -> str:
        """Name of what it is at."""
        ...


class EpisodeProgress:
    """Shows simulated time, the stage, what holds of the task and the speed relative to real time."""

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

    def tick(self, episode: Running) -> None:
        """Bring the bar up to date."""
        factor = episode.t / max(time.monotonic() - self._started, 1e-3)
        holding = episode.judge.holding
        self._bar.update(
            self._task,
            description=printable(episode.trial.task.name),
            completed=episode.t,
            total=episode.time_limit_s,
            status=f"{episode.t:5.1f} s simulated · {printable(episode.stage, 40)} · "
            f"{sum(holding)} of {len(holding)} conditions · {factor:.2f}x real time",
        )

    def stop_requested(self) -> str:
        """A progress bar never stops an episode."""
        return ""

    def close(self) -> None:
        """Leave the last state on the screen."""
        self._bar.stop()
