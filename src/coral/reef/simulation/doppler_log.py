"""A simulated Doppler velocity log: velocity over ground and altitude, with a DVL A50's errors and outages."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coral.config import NonNegative, Positive


@dataclass(frozen=True, kw_only=True)
class DvlCfg:
    """Errors of a Water Linked DVL A50. "Maker" is its documentation; other figures are ours, measured by nobody."""

    rate_hz: Positive = 10.0
    """Pings a second: 10 at 0.3 to 3 m above the sea floor, 5 to 15 elsewhere (maker, "Range mode")."""
    noise_m_s: NonNegative = 0.005
    """Standard deviation of each horizontal velocity (m/s). Ours: the maker's example of a report says 0.0002 m/s at
    rest in a bucket. It is reported as the figure of merit."""
    bias_m_s: NonNegative = 0.001
    """Standard deviation of an offset that stays for a dive: "long term accuracy 0.1 cm/s" (maker)."""
    scale: NonNegative = 0.01
    """Standard deviation of a scale error that stays for a dive: 1 % in the standard version, 0.1 % in the other
    (maker). A wrong speed of sound has the same effect."""
    misalignment_rad: NonNegative = 0.0087
    """Standard deviation of the angle between log and hull: 0.5 degrees. Ours."""
    altitude_scale: NonNegative = 0.01
    """Standard deviation of the altitude's scale error, as that of the velocity."""
    cycle_s: NonNegative = 10.0
    """Period at which the log checks its bottom lock and loses some pings ("periodic cycling", maker). 0: never."""
    cycle_lost_s: NonNegative = 0.2
    """Time for which they are lost. Ours: the maker says "some measurements"."""
    outage_rate_hz: NonNegative = 1.0 / 120.0
    """Other losses of bottom lock, per second: bubbles, weeds, steep walls. Ours."""
    outage_s: Positive = 1.0
    """Their mean length. Ours."""
    range_m: Positive = 50.0
    """Greatest altitude with bottom lock (maker)."""


@dataclass(frozen=True)
class DvlReading:
    """One ping with bottom lock."""

    forward_m_s: float
    left_m_s: float
    altitude_m: float
    std_m_s: float
    """Figure of merit: standard deviation of each velocity by noise alone."""


class SimulatedDvl:
    """Measures velocity over ground when a ping is due and the bottom is heard.

    z = (1 + s) R(m) (u, v) + b + n: scale error s, misalignment m and offset b are drawn once, n is white noise.
    """

    def __init__(self, cfg: DvlCfg, rng: np.random.Generator) -> None:
        """Draw the errors that stay for a dive."""
        self.cfg, self._rng = cfg, rng
        draws = rng.standard_normal(5).tolist()
        self.scale, self.misalignment_rad = cfg.scale * draws[0], cfg.misalignment_rad * draws[1]
        self.bias = cfg.bias_m_s * draws[2], cfg.bias_m_s * draws[3]
        self._altitude_scale = 1.0 + cfg.altitude_scale * draws[4]
        self._t = 0.0
        self._next_s = 0.0
        self._lost_until_s = 0.0

    def measure(self, velocity: tuple[float, float], altitude_m: float, dt: float) -> DvlReading | None:
        """Return what a ping says `dt` seconds (s) after the last call; None if none is due or the bottom is not heard.

        Args:
            velocity: True velocity over ground, forward and left (m/s).
            altitude_m: True height above the sea floor (m).
            dt: Time since the last call (s).
        """
        cfg, rng = self.cfg, self._rng
        self._t += dt
        if cfg.outage_rate_hz > 0.0 and rng.random() < 1.0 - math.exp(-cfg.outage_rate_hz * dt):
            self._lost_until_s = self._t + float(rng.exponential(cfg.outage_s))
        if self._t < self._next_s - 1e-9:
            return None
        self._next_s = max(self._next_s + 1.0 / cfg.rate_hz, self._t)
        noise = rng.standard_normal(2)
        if self._is_cycling() or self._t < self._lost_until_s or not 0.0 < altitude_m <= cfg.range_m:
            return None
        c, s = math.cos(self.misalignment_rad), math.sin(self.misalignment_rad)
        u, v = velocity
        return DvlReading(
            forward_m_s=(1.0 + self.scale) * (c * u - s * v) + self.bias[0] + cfg.noise_m_s * float(noise[0]),
            left_m_s=(1.0 + self.scale) * (s * u + c * v) + self.bias[1] + cfg.noise_m_s * float(noise[1]),
            altitude_m=altitude_m * self._altitude_scale,
            std_m_s=cfg.noise_m_s,
        )

    def _is_cycling(self) -> bool:
        t, cfg = self._t + 1e-6, self.cfg
        return cfg.cycle_s > 0.0 and t >= cfg.cycle_s and t % cfg.cycle_s < cfg.cycle_lost_s
