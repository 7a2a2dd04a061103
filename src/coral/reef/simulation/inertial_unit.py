"""A simulated inertial measurement unit: turn rate, specific force and tilt, with the errors of a MEMS sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coral.config import NonNegative

GRAVITY_M_S2 = 9.81


@dataclass(frozen=True, kw_only=True)
class ImuCfg:
    """Errors of the sensor. "ICM-20602" is the data sheet of one that flight controllers carry; others are ours."""

    gyro_noise: NonNegative = 7.0e-5
    """Noise of the turn rate (rad/s/√Hz): 4 mdps/√Hz (ICM-20602)."""
    gyro_bias_rad_s: NonNegative = 5.8e-5
    """Standard deviation of its offset after a calibration at rest: 0.2 degrees a minute, the middle of the 0.1 to 0.3
    that the DVL A50's maker states for its own ("Yaw drift")."""
    gyro_bias_walk: NonNegative = 1.0e-6
    """Random walk of that offset (rad/s/√s), by temperature. Ours."""
    gyro_scale: NonNegative = 0.005
    """Standard deviation of a scale error that stays: half of its initial tolerance of 1 % (ICM-20602)."""
    force_noise: NonNegative = 9.8e-4
    """Noise of the specific force (m/s²/√Hz): 100 µg/√Hz (ICM-20602)."""
    force_bias_m_s2: NonNegative = 0.05
    """Standard deviation of its offset: 5 mg, with what a wrong tilt lets through of gravity. Ours; without calibration
    it is 40 mg (ICM-20602)."""
    force_bias_walk: NonNegative = 0.002
    """Random walk of its offset (m/s²/√s), by temperature and a changing error of the tilt: after 600 s as large as at
    the start. Ours."""
    force_scale: NonNegative = 0.005
    """Standard deviation of its scale error, as that of the gyro."""
    tilt_bias_rad: NonNegative = 0.005
    """Standard deviation of an error of roll and pitch that stays: that of the force over gravity."""
    tilt_noise_rad: NonNegative = 0.002
    """Standard deviation of their noise. Ours."""


@dataclass(frozen=True)
class ImuReading:
    """The means since the last reading, in the body frame (FLU), without gravity."""

    turn_rad_s: float
    forward_m_s2: float
    left_m_s2: float
    roll_rad: float
    pitch_rad: float


class SimulatedImu:
    """Measures the mean turn rate and specific force of an interval, and the tilt at its end."""

    def __init__(self, cfg: ImuCfg, rng: np.random.Generator) -> None:
        """Draw the errors that stay for a dive."""
        self.cfg, self._rng = cfg, rng
        draws = rng.standard_normal(7).tolist()
        self.gyro_bias_rad_s = cfg.gyro_bias_rad_s * draws[0]
        self._force_bias = cfg.force_bias_m_s2 * draws[1], cfg.force_bias_m_s2 * draws[2]
        self._tilt_bias = cfg.tilt_bias_rad * draws[3], cfg.tilt_bias_rad * draws[4]
        self._gyro_gain, self._force_gain = 1.0 + cfg.gyro_scale * draws[5], 1.0 + cfg.force_scale * draws[6]

    def measure(
        self, turn_rad_s: float, force_m_s2: tuple[float, float], tilt: tuple[float, float], dt: float
    ) -> ImuReading:
        """Return a reading for an interval.

        Args:
            turn_rad_s: True mean turn rate, positive to the left.
            force_m_s2: True mean specific force forward and left, without gravity.
            tilt: True roll and pitch at the end (rad).
            dt: Length of the interval (s).
        """
        cfg, draws = self.cfg, self._rng.standard_normal(8).tolist()
        # White noise of density N has a standard deviation of N / √dt in the mean over dt.
        gyro, force = cfg.gyro_noise / math.sqrt(dt), cfg.force_noise / math.sqrt(dt)
        self.gyro_bias_rad_s += cfg.gyro_bias_walk * math.sqrt(dt) * draws[0]
        walk = cfg.force_bias_walk * math.sqrt(dt)
        self._force_bias = self._force_bias[0] + walk * draws[6], self._force_bias[1] + walk * draws[7]
        return ImuReading(
            turn_rad_s=self._gyro_gain * turn_rad_s + self.gyro_bias_rad_s + gyro * draws[1],
            forward_m_s2=self._force_gain * force_m_s2[0] + self._force_bias[0] + force * draws[2],
            left_m_s2=self._force_gain * force_m_s2[1] + self._force_bias[1] + force * draws[3],
            roll_rad=tilt[0] + self._tilt_bias[0] + cfg.tilt_noise_rad * draws[4],
            pitch_rad=tilt[1] + self._tilt_bias[1] + cfg.tilt_noise_rad * draws[5],
        )

    @property
    def tilt_std_rad(self) -> float:
        """Standard deviation of roll and pitch."""
        return math.hypot(self.cfg.tilt_bias_rad, self.cfg.tilt_noise_rad)
