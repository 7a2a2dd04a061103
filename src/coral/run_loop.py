"""Advances a run to its end while observers watch, and summarises its timing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

import numpy as np

from coral.interrupts import holding_interrupts, uninterrupted


class Run(Protocol):
    """A mission or an episode: it advances until it has an end reason."""

    end_reason: str

    def advance(self) -> None:
        """Execute the next control steps."""


R_contra = TypeVar("R_contra", contravariant=True)
R = TypeVar("R", bound=Run)


class Observer(Protocol[R_contra]):
    """Watches a run: a progress bar, a live view."""

    def tick(self, run: R_contra, /) -> None:
        """Handle the state after an `advance`; called after each one."""

    def stop_requested(self) -> str:
        """Return the reason to stop now, or ""."""


def run_to_end(run: R, observers: Sequence[Observer[R]]) -> None:
    """Advance a run until it ends or an observer stops it. An interrupt waits for the end of an `advance`."""
    while not run.end_reason:
        with uninterrupted():
            run.advance()
        for observer in observers:
            observer.tick(run)
            run.end_reason = run.end_reason or observer.stop_requested()


@contextmanager
def stoppable(run: Run) -> Iterator[None]:
    """Convert an interrupt to an end reason: its signal if it names one, else the operator."""
    try:
        with holding_interrupts():
            yield
    except KeyboardInterrupt as stop:
        run.end_reason = str(stop) or "stopped by the operator"


def timing_of(wall_s: float, sim_s: float, **samples_ms: Sequence[float]) -> dict[str, float]:
    """Compute the content of timing.json; durations, such as `plan_ms`, each give a median and a 99th percentile."""
    found = {"wall_time_s": round(wall_s, 3), "realtime_factor": round(sim_s / wall_s, 3) if wall_s else 0.0}
    for name, samples in samples_ms.items():
        values = np.array(samples) if samples else np.zeros(1)
        found[f"{name}_median"] = round(float(np.median(values)), 3)
        found[f"{name}_p99"] = round(float(np.percentile(values, 99)), 3)
    return found
