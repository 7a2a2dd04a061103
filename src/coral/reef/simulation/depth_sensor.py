"""A simulated depth sensor: the pressure of the water, with the errors of a Bar30."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coral.config import NonNegative


@dataclass(frozen=True, kw_only=True)
class DepthSensorCfg:
    """Errors of the sensor."""

    noise_m: NonNegative = 0.005
    """Standard deviation of a depth. Ours: two to three of its steps."""
    resolution_m: NonNegative = 0.002
    """Step of the depths: 0.2 mbar (data sheet of the MS5837-30BA, which is inside)."""
    offset_m: NonNegative = 0.02
    """Standard deviation of an error that stays for a dive: set to 0 at the surface, between waves. Ours."""


class SimulatedDepthSensor:
    """Measures the depth."""

    def __init__(self, cfg: DepthSensorCfg, rng: np.random.Generator) -> None:
        """Draw the offset of a dive."""
        self.cfg, self._rng = cfg, rng
        self._offset_m = cfg.offset_m * float(rng.standard_normal())

    def measure(self, depth_m: float) -> float:
        """Return a depth (m) for the true one."""
        cfg = self.cfg
        found = depth_m + self._offset_m + cfg.noise_m * float(self._rng.standard_normal())
        return round(found / cfg.resolution_m) * cfg.resolution_m if cfg.resolution_m > 0.0 else found
