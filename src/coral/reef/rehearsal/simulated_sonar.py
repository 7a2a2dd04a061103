"""The simulated sonar in real time: range images of a simulated reef from where a vehicle is."""

from __future__ import annotations

import time
from collections.abc import Callable

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.rehearsal.simulated_camera import Where
from coral.reef.sea.latest_reading import HeardImage
from coral.reef.sea.real_time import FixedRate


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
