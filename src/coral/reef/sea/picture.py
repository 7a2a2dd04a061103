"""Pictures of a camera, and what eyes see in them: beside the control loop, on the camera's thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.sea.latest_reading import LatestReading, SensorSource
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame


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
