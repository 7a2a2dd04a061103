"""Range images of a sonar as they come: any source, read on a thread of its own, the newest image kept."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from coral.errors import first_line
from coral.reef.checks import UnfitMeasurement
from coral.reef.sonar.range_image import RangeImage

PAUSE_S = 0.2
"""A source that fails is asked again after this time."""


@dataclass(frozen=True)
class HeardImage:
    """One range image."""

    stamp_s: float
    """Monotonic time of its ping (s)."""
    image: RangeImage


class SonarSource(Protocol):
    """A sonar."""

    @property
    def name(self) -> str:
        """As in the preflight list: where its images come from."""
        ...

    def read(self) -> HeardImage | None:
        """Wait for the next image; None when there is none this time.

        Raises:
            UnfitMeasurement: What came is no image, with the name of what is wrong.
        """
        ...

    def close(self) -> None:
        """Free the sonar."""
        ...


class LatestHeard:
    """Reads a sonar on a thread of its own and keeps the newest image."""

    def __init__(
        self, source: SonarSource, *, clock: Callable[[], float] = time.monotonic, threaded: bool = True
    ) -> None:
        """Start reading; without `threaded`, `step` reads one image, for tests."""
        self.source = source
        self.failure = ""
        """What the sonar last complained of, or ""."""
        self.refused: Counter[str] = Counter()
        """Packets that were refused, by the name of what was wrong."""
        self._clock = clock
        self._latest: HeardImage | None = None
        self._times: list[float] = []
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._work, name="coral-sonar", daemon=True) if threaded else None
        if self._thread is not None:
            self._thread.start()

    @property
    def latest(self) -> HeardImage | None:
        """The newest image."""
        return self._latest

    @property
    def rate_hz(self) -> float:
        """Images a second, over the last ones."""
        times = self._times[-20:]
        return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 and times[-1] > times[0] else 0.0

    def step(self) -> None:
        """Read one image."""
        try:
            heard = self.source.read()
        except UnfitMeasurement as unfit:
            self.refused[unfit.reason] += 1
            self.failure = f"{unfit.reason} ({unfit.detail})" if unfit.detail else unfit.reason
            return
        except Exception as error:  # a sonar may fail in any way; the guard stops the vehicle when nothing comes
            self.failure = first_line(error)
            self._closing.wait(PAUSE_S)
            return
        if heard is not None:
            self.failure, self._latest = "", heard
            self._times = [*self._times[-40:], self._clock()]

    def close(self) -> None:
        """Stop reading and free the sonar."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(2.0)
        self.source.close()

    def _work(self) -> None:
        while not self._closing.is_set():
            self.step()
