"""Progress and remaining time of a campaign, on standard error."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from coral.campaign.episode import EpisodeOutcome
from coral.odd_text import printable
from coral.words import many

LINE_EVERY_S = 15.0
"""Maximum rate of lines without a terminal, so that a log stays readable."""


class CampaignProgress:
    """Shows a bar in a terminal, an occasional line elsewhere."""

    def __init__(
        self, *, quiet: bool = False, clock: Callable[[], float] = time.monotonic, console: Console | None = None
    ) -> None:
        self._console = console or Console(stderr=True)
        self._quiet, self._clock = quiet, clock
        self._bar = Progress(
            TextColumn("[bold]episodes"),
            BarColumn(bar_width=24),
            TextColumn("{task.fields[status]}", markup=False),
            console=self._console,
            disable=quiet or not self._console.is_terminal,
            refresh_per_second=4,
        )
        self._task = self._bar.add_task("", total=1.0, status="")
        self._total = self._found = self._ended = self._failed = 0
        self._jobs = 1
        self._begun = self._told = 0.0

    def begin(self, total: int, found: int, jobs: int) -> None:
        """Start counting the episodes of a grid, of which some were found recorded, with so many jobs at once."""
        self._total, self._found, self._jobs = total, found, jobs
        self._begun = self._told = self._clock()
        self._bar.start()
        self._show("")
        if found and not self._quiet:
            self._console.print(f"recorded before: {found} of {many(total, 'episode')}", highlight=False)

    def ended(self, outcome: EpisodeOutcome) -> None:
        """Count an episode; a failure is reported at once."""
        self._ended += 1
        self._failed += outcome.result is None
        if outcome.result is None and not self._quiet:
            self._console.print(
                f"failed: {outcome.spec.key}: {printable(outcome.message)}", markup=False, highlight=False
            )
        self._show(outcome.spec.key)

    def status(self) -> str:
        """Format counts and remaining time."""
        done = self._found + self._ended
        left = self._total - done
        parts = [f"{done} of {self._total}"]
        parts += [f"{self._failed} failed"] if self._failed else []
        if self._ended and left:
            # The last episodes leave workers idle, so the rate counts only after a full round.
            rounds = max(left / self._ended, 1.0 / max(1.0, self._ended / self._jobs))
            parts.append(f"about {duration(rounds * (self._clock() - self._begun))} left")
        elif not left:
            parts.append(f"in {duration(self._clock() - self._begun)}")
        return " · ".join(parts)

    def close(self) -> None:
        """Keep the last state on the screen."""
        self._bar.stop()

    def _show(self, key: str) -> None:
        status = self.status()
        self._bar.update(self._task, completed=self._found + self._ended, total=max(1, self._total), status=status)
        if self._quiet or self._console.is_terminal:
            return
        now, over = self._clock(), self._ended and self._found + self._ended == self._total
        if over or (key and now - self._told >= LINE_EVERY_S):
            self._told = now
            self._console.print(f"{status} · last: {key}", markup=False, highlight=False, soft_wrap=True)


def duration(seconds: float) -> str:
    """Format a duration: 45 s, 12 min, 3 h 20 min."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
