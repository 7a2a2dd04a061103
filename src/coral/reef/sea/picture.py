"""Pictures of a camera, and what perception makes of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.reef.sea.latest_reading import LatestReading
from coral.reef.world.geometry import Frame


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


class LatestShot(LatestReading[Shot]):
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
        super().__init__(source, "coral-camera", clock=clock, threaded=threaded)

    def _read(self) -> Shot | None:
        shot = self.source.read()
        if shot is None or shot.frame is not None or shot.rgb is None or self.perception is None:
            return shot
        frame = self.perception.perceive(shot.rgb)
        if frame.rgb is None and shot.rgb.shape[:2] == frame.depth.shape:
            frame = replace(frame, rgb=shot.rgb)  # for the record
        return Shot(stamp_s=shot.stamp_s, rgb=shot.rgb, frame=frame)
