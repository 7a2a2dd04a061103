"""Simulated sonar and camera in real time: a simulated reef from where a vehicle is, at a sensor's rate."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.sea.picture import Shot
from coral.reef.sea.real_time import FixedRate
from coral.reef.simulation.noise import SensorNoise
from coral.reef.simulation.stills import Stills
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.sensing import HeardImage
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene

Where = Callable[[], tuple[float, Pose] | None]
"""where() returns a monotonic time (s) and the pose of the vehicle in the reef at that time; None while unknown."""


class SimulatedSonar:
    """Takes images at the sonar's rate. Around a real autopilot the reef exists only here."""

    def __init__(
        self,
        sonar: Sonar3d15,
        where: Where,
        altitude_m: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Set up; `where` tells a monotonic time (s) and the pose of the vehicle, at an altitude (m)."""
        self._sonar, self._where, self._altitude_m = sonar, where, altitude_m
        self._rate = FixedRate(1.0 / sonar.cfg.rate_hz, clock, sleep)
        self.name = "simulated"

    def read(self) -> HeardImage | None:
        """Wait for the next ping; None while nobody knows where the vehicle is."""
        self._rate.wait()
        found = self._where()
        heard = None if found is None else HeardImage(found[0], self._sonar.image(found[1], self._altitude_m))
        self._rate.finish()
        return heard

    def close(self) -> None:
        """Nothing to free."""


class SimulatedCamera:
    """Renders depth and classes, and colours on request. Around a real autopilot the reef exists only here."""

    def __init__(
        self,
        scene: Scene,
        cfg: CameraCfg,
        where: Where,
        rate_hz: float = 10.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        painter: Any = None,
        noise: SensorNoise | None = None,
        stills: Stills | None = None,
    ) -> None:
        """Set up; `where` tells a monotonic time (s) and the pose of the vehicle. Without noise all is exact."""
        self._camera, self._where, self._painter, self._noise = Camera(scene, cfg), where, painter, noise
        self._stills = stills
        self._begun: float | None = None
        self._rate = FixedRate(1.0 / rate_hz, clock, sleep)
        self.name = f"simulated, {cfg.width}x{cfg.height}"

    def read(self) -> Shot | None:
        """Wait for the next exposure; None while nobody knows where the vehicle is."""
        self._rate.wait()
        found = self._where()
        shot = None if found is None else Shot(stamp_s=found[0], frame=self._take(*found))
        self._rate.finish()
        return shot

    def _take(self, stamp_s: float, pose: Pose) -> Frame:
        if self._begun is None:
            self._begun = stamp_s
        t = stamp_s - self._begun
        exact = self._camera.render(pose, t=t)
        frame = exact if self._noise is None else self._noise.apply(exact)
        if self._stills is not None:
            frame = self._stills.of(frame, pose, t)
        return frame if self._painter is None else replace(frame, rgb=self._painter.paint(exact, pose, t=t))

    def close(self) -> None:
        """Nothing to free."""
