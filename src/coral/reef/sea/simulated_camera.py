"""The simulated camera: pictures of a simulated reef from where a vehicle is, at a camera's rate."""

from __future__ import annotations

import time
from collections.abc import Callable

from coral.reef.camera import Camera, CameraCfg
from coral.reef.geometry import Pose
from coral.reef.scene import Scene
from coral.reef.sea.loop import FixedRate
from coral.reef.sea.picture import Shot

Where = Callable[[], tuple[float, Pose] | None]
"""where() returns a monotonic time (s) and the pose of the vehicle in the reef at that time; None while unknown."""


class SimulatedCamera:
    """Renders exact depth and classes. Around a real autopilot the reef exists only here."""

    labelled = True

    def __init__(
        self,
        scene: Scene,
        cfg: CameraCfg,
        where: Where,
        rate_hz: float = 10.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._camera, self._where = Camera(scene, cfg), where
        self._rate = FixedRate(1.0 / rate_hz, clock, sleep)
        self.name = f"simulated, {cfg.width}x{cfg.height}"

    def read(self) -> Shot | None:
        """Wait for the next exposure; None while nobody knows where the vehicle is."""
        self._rate.wait()
        found = self._where()
        shot = None if found is None else Shot(stamp_s=found[0], frame=self._camera.render(found[1]))
        self._rate.finish()
        return shot

    def close(self) -> None:
        """Nothing to free."""
