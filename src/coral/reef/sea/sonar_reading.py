"""Range images of a sonar as they come: any source, read on a thread of its own, the newest image kept."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.latest_reading import LatestReading
from coral.reef.vehicle.range_image import RangeImage


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


class LatestHeard(LatestReading[HeardImage]):
    """Reads a sonar on a thread of its own and keeps the newest image."""

    def __init__(
        self, source: SonarSource, *, clock: Callable[[], float] = time.monotonic, threaded: bool = True
    ) -> None:
        """Start reading; without `threaded`, `step` reads one image, for tests."""
        self.source = source
        self.refused: Counter[str] = Counter()
        """Packets that were refused, by the name of what was wrong."""
        super().__init__(source, "coral-sonar", clock=clock, threaded=threaded)

    def _read(self) -> HeardImage | None:
        try:
            return self.source.read()
        except UnfitMeasurement as unfit:
            self.refused[unfit.reason] += 1
            self.failure = f"{unfit.reason} ({unfit.detail})" if unfit.detail else unfit.reason
            return None
