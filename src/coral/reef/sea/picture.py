"""Pictures of a camera, and what perception makes of them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.errors import first_line
from coral.reef.geometry import Frame


@dataclass(frozen=True, kw_only=True)
class Shot:
    """One picture of the front camera."""

    stamp_s: float
    """Monotonic time at which it was taken (s): arrival minus the camera's latency."""
    rgb: NDArray[np.uint8] | None = None
    """Shape=(H, W, 3); None from the simulated camera, which makes no colours here."""
    frame: Frame | None = None
    """Depth and class of every pixel; None until a perception has made them."""


class Perception(Protocol):
    """Makes depth and classes from a colour picture.

    None ships today: there is no network here that segments oysters or measures depth in a real camera's picture.
    """

    name: str

    def perceive(self, rgb: NDArray[np.uint8]) -> Frame:
        """Return depth and classes in the size of `CameraCfg`.

        Args:
            rgb: Shape=(H, W, 3).
        """
        ...


class CameraSource(Protocol):
    """A camera."""

    name: str
    """As in the preflight list: kind and size."""
    labelled: bool
    """Whether its pictures have depth and classes of their own."""

    def read(self) -> Shot | None:
        """Wait for the next picture; None when there is none this time."""
        ...

    def close(self) -> None:
        """Free the camera."""
        ...


class LatestShot:
    """Reads a camera on a thread of its own and keeps the newest picture, perceived."""

    def __init__(
        self,
        source: CameraSource,
        perception: Perception | None = None,
        *,
        clock: Callable[[], float] = time.monotonic,
        threaded: bool = True,
    ) -> None:
        """Start reading; without `threaded`, `step` reads one picture, for tests."""
        self.source, self.perception = source, perception
        self.failure = ""
        """What the camera last complained of, or ""."""
        self._clock = clock
        self._latest: Shot | None = None
        self._times: list[float] = []
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._work, name="coral-camera", daemon=True) if threaded else None
        if self._thread is not None:
            self._thread.start()

    @property
    def latest(self) -> Shot | None:
        """The newest picture."""
        return self._latest

    @property
    def rate_hz(self) -> float:
        """Pictures a second, over the last ones."""
        times = self._times[-20:]
        return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 and times[-1] > times[0] else 0.0

    def step(self) -> None:
        """Read one picture."""
        try:
            shot = self.source.read()
            if shot is not None and shot.frame is None and shot.rgb is not None and self.perception is not None:
                frame = self.perception.perceive(shot.rgb)
                if frame.rgb is None and shot.rgb.shape[:2] == frame.depth.shape:
                    frame = replace(frame, rgb=shot.rgb)  # for the record
                shot = Shot(stamp_s=shot.stamp_s, rgb=shot.rgb, frame=frame)
        except Exception as error:  # a camera may fail in any way; the guard stops the vehicle when none comes
            self.failure = first_line(error)
            self._closing.wait(0.2)
            return
        if shot is not None:
            self.failure, self._latest = "", shot
            self._times = [*self._times[-40:], self._clock()]

    def close(self) -> None:
        """Stop reading and free the camera."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(2.0)
        self.source.close()

    def _work(self) -> None:
        while not self._closing.is_set():
            self.step()
