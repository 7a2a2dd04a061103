"""Simulated sonar and camera in real time: a simulated reef from where a vehicle is, at a sensor's rate."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Generic, TypeVar

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.sea.latest_reading import Shot
from coral.reef.sea.real_time import RealTicks
from coral.reef.simulation.noise import SensorNoise
from coral.reef.simulation.stills import Stills
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.sensing import HeardImage
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene

T = TypeVar("T")
Where = Callable[[], tuple[float, Pose] | None]
"""where() returns a monotonic time (s) and the pose of the vehicle in the reef at that time; None while unknown."""


class SimulatedSensor(Generic[T]):
    """Measures at a fixed rate. Around a real autopilot the reef exists only here."""

    def __init__(
        self,
        name: str,
        rate_hz: float,
        where: Where,
        measure: Callable[[float, Pose], T],
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Set up; measure(t, pose) returns what the sensor finds at a monotonic time (s) and a pose of the vehicle."""
        self.name, self._where, self._measure = name, where, measure
        self._ticks = RealTicks(1.0 / rate_hz, clock, sleep)

    def read(self) -> T | None:
        """Wait for the next measurement; None while nobody knows where the vehicle is."""
        self._ticks.wait()
        found = self._where()
        measured = None if found is None else self._measure(*found)
        self._ticks.finish()
        return measured

    def close(self) -> None:
        """Nothing to free."""


def simulated_sonar(sonar: Sonar3d15, where: Where, altitude_m: float, **timing: Any) -> SimulatedSensor[HeardImage]:
    """Make a sonar that takes images at its rate, at an altitude (m)."""

    def hear(t: float, pose: Pose) -> HeardImage:
        return HeardImage(t, sonar.image(pose, altitude_m))

    return SimulatedSensor("simulated", sonar.cfg.rate_hz, where, hear, **timing)


def simulated_camera(
    scene: Scene,
    cfg: CameraCfg,
    where: Where,
    rate_hz: float = 10.0,
    *,
    painter: Any = None,
    noise: SensorNoise | None = None,
    stills: Stills | None = None,
    **timing: Any,
) -> SimulatedSensor[Shot]:
    """Make a camera that renders depth and classes, and colours with a painter. Without noise all is exact."""
    camera, begun = Camera(scene, cfg), list[float]()

    def take(stamp_s: float, pose: Pose) -> Shot:
        if not begun:
            begun.append(stamp_s)
        t = stamp_s - begun[0]
        exact = camera.render(pose, t=t)
        frame: Frame = exact if noise is None else noise.apply(exact)
        if stills is not None:
            frame = stills.of(frame, pose, t)
        if painter is not None:
            frame = replace(frame, rgb=painter.paint(exact, pose, t=t))
        return Shot(stamp_s=stamp_s, frame=frame)

    return SimulatedSensor(f"simulated, {cfg.width}x{cfg.height}", rate_hz, where, take, **timing)
