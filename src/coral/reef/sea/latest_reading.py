"""The newest measurement of a sensor, or picture of a camera with what eyes see in it: read on a thread of its own."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.errors import first_line
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame

PAUSE_S = 0.2
"""A sensor that fails is asked again after this time."""
KEPT = 200
"""The rate is that of at most this many measurements."""
RATE_S = 1.0
"""Over a shorter time no rate is told: sensors send bursts after a pause, a link after a gap."""
T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class SensorSource(Protocol[T_co]):
    """A sensor."""

    @property
    def name(self) -> str:
        """As in the preflight list: kind, size, where it comes from."""

    def read(self) -> T_co | None:
        """Wait for the next measurement; None when there is none this time.

        Raises:
            UnfitMeasurement: What came is no measurement, with the name of what is wrong.
        """

    def close(self) -> None:
        """Free the sensor."""


def rate_of(times: Sequence[float]) -> float | None:
    """Return how many times a second something came (Hz), by the times (s) at which it did; None if not known."""
    span = times[-1] - times[0] if len(times) > 1 else 0.0
    return (len(times) - 1) / span if span >= RATE_S else None


def rate_told(rate_hz: float | None) -> str:
    """Return a rate in words."""
    return "rate not known" if rate_hz is None else f"{rate_hz:.0f} Hz" if rate_hz >= 1.0 else f"{rate_hz:.1f} Hz"


class LatestReading(Generic[T]):
    """The newest measurement of a sensor, its rate, and what the sensor last complained of.

    It is read on a thread of this name; without `threaded`, `step` reads one measurement, for tests.
    """

    def __init__(
        self, source: SensorSource[T], name: str, *, clock: Callable[[], float] = time.monotonic, threaded: bool = True
    ) -> None:
        self.failure = ""
        """What the sensor last complained of, or ""."""
        self.refused: Counter[str] = Counter()
        """Measurements that were refused, by the name of what was wrong."""
        self.source, self._clock = source, clock
        self.latest: T | None = None
        """The newest measurement."""
        self._times: list[float] = []
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._work, name=name, daemon=True) if threaded else None
        if self._thread is not None:
            self._thread.start()

    def _read(self) -> T | None:
        return self.source.read()

    @property
    def rate_hz(self) -> float | None:
        """Measurements a second, over the last ones; None if it is not known yet."""
        return rate_of(self._times[-KEPT:])

    def step(self) -> None:
        """Read one measurement."""
        try:
            found = self._read()
        except UnfitMeasurement as unfit:
            self.refused[unfit.reason] += 1
            self.failure = f"{unfit.reason} ({unfit.detail})" if unfit.detail else unfit.reason
            return
        except Exception as error:  # a sensor may fail in any way; the guard stops the vehicle when nothing comes
            self.failure = first_line(error)
            self._closing.wait(PAUSE_S)
            return
        if found is not None:
            self.failure, self.latest = "", found
            self._times = [*self._times[-2 * KEPT :], self._clock()]

    def close(self) -> None:
        """Stop reading and free the sensor."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(2.0)
        self.source.close()

    def _work(self) -> None:
        while not self._closing.is_set():
            self.step()


@dataclass(frozen=True, kw_only=True)
class Shot:
    """One picture of the front camera."""

    stamp_s: float
    """Monotonic time at which it was taken (s): arrival minus the camera's latency."""
    rgb: NDArray[np.uint8] | None = None
    """Shape=(H, W, 3); None from the simulated camera where no colours are painted."""
    frame: Frame | None = None
    """Depth and class of every pixel; None until eyes have found them."""


class LatestShot(LatestReading[Shot]):
    """Reads a camera on a thread of its own and keeps the newest picture, with what eyes saw in it."""

    def __init__(
        self,
        source: SensorSource[Shot],
        eyes: RgbPerception | None = None,
        camera: CameraCfg | None = None,
        *,
        clock: Callable[[], float] = time.monotonic,
        threaded: bool = True,
    ) -> None:
        """Start reading; without `threaded`, `step` reads one picture, for tests.

        Eyes find classes and depth in the colours of pictures of `camera`; None if its pictures have them.
        """
        self.eyes, self._camera = eyes, camera or CameraCfg()
        self.attitude: Callable[[], CameraAttitude] = CameraAttitude
        """Tells the camera's attitude as it is measured."""
        self.seeing_s = 0.0
        """Time that eyes took for the last picture: it was older by this when it reached the pilot (s)."""
        super().__init__(source, "coral-camera", clock=clock, threaded=threaded)

    def _read(self) -> Shot | None:
        shot = self.source.read()
        if shot is None or self.eyes is None:
            return shot
        rgb = shot.rgb if shot.rgb is not None or shot.frame is None else shot.frame.rgb
        if rgb is None:
            return shot
        begun = self._clock()
        frame = perceive_frame(Frame.of_colours(rgb), self.eyes, self._camera, self.attitude())
        self.seeing_s = self._clock() - begun
        return replace(shot, frame=frame)
