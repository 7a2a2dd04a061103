"""Dead reckoning by a Kalman filter: the IMU predicts, the Doppler log corrects, nothing else helps."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.simulation.doppler_log import DvlCfg, DvlReading
from coral.reef.simulation.inertial_unit import ImuCfg, ImuReading
from coral.reef.world.geometry import Pose, wrap

X, Y, THETA, U, V, GYRO, FORCE_U, FORCE_V, SCALE, ANGLE, BIAS_U, BIAS_V, GYRO_SCALE, FORCE_SCALE = range(14)
SIZE = 14
START_SPEED_M_S = 0.1
"""Standard deviation of each velocity at the start: a vehicle that waits drifts with the water."""
"""State: pose; velocity over ground in the body frame; offsets of gyro and accelerometer; scale error, misalignment
and offset of the log; scale errors of gyro and accelerometer."""


class InertialFilter:
    """Extended Kalman filter over pose, body velocity and the sensors' constant errors.

    Prediction with the turn rate w and the specific force f of the IMU, less their estimated errors:
        x' = x + R(theta) (u, v) dt,  theta' = theta + w dt,  (u, v)' = (u, v) + (f + w (v, -u)) dt
    Correction with the log: z = (1 + s) R(m) (u, v) + b + n. A constant error that nothing measures keeps its variance,
    and its effect on the pose stays in the covariance, however long it takes.
    """

    def __init__(self, start: Pose, imu: ImuCfg, dvl: DvlCfg) -> None:
        """Begin at a known pose, nearly at rest."""
        self._imu = imu
        self.state = np.zeros(SIZE)
        self.state[:3] = start
        sigma = np.zeros(SIZE)
        sigma[[GYRO, FORCE_U, FORCE_V]] = imu.gyro_bias_rad_s, imu.force_bias_m_s2, imu.force_bias_m_s2
        sigma[[SCALE, ANGLE, BIAS_U, BIAS_V]] = dvl.scale, dvl.misalignment_rad, dvl.bias_m_s, dvl.bias_m_s
        sigma[[U, V]] = START_SPEED_M_S
        sigma[[GYRO_SCALE, FORCE_SCALE]] = imu.gyro_scale, imu.force_scale
        self.full_covariance = np.diag(sigma**2)
        """Of the whole state. Shape=(14, 14)."""

    @property
    def pose(self) -> Pose:
        """The estimated pose."""
        return Pose(*self.state[:3].tolist())

    @property
    def velocity(self) -> tuple[float, float]:
        """The estimated velocity over ground, forward and left (m/s)."""
        return float(self.state[U]), float(self.state[V])

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of the pose: x, y (m), theta (rad). Shape=(3, 3)."""
        return self.full_covariance[:3, :3].copy()

    def predict(self, reading: ImuReading, dt: float) -> None:
        """Move on by an interval of `dt` seconds with what the IMU measured in it."""
        x = self.state
        turn = (reading.turn_rad_s - x[GYRO]) / (1.0 + x[GYRO_SCALE])
        gain = 1.0 + x[FORCE_SCALE]
        forward, left = (reading.forward_m_s2 - x[FORCE_U]) / gain, (reading.left_m_s2 - x[FORCE_V]) / gain
        u, v = float(x[U]), float(x[V])
        du = (forward + turn * v) * dt
        mean_u = u + 0.5 * du
        dv = (left - turn * mean_u) * dt
        middle = x[THETA] + 0.5 * turn * dt
        c, s = math.cos(middle), math.sin(middle)
        mean_v = v + 0.5 * dv
        dx, dy = (c * mean_u - s * mean_v) * dt, (s * mean_u + c * mean_v) * dt
        jacobian = np.eye(SIZE)
        jacobian[X, THETA], jacobian[Y, THETA] = -dy, dx
        jacobian[X, U], jacobian[X, V], jacobian[Y, U], jacobian[Y, V] = c * dt, -s * dt, s * dt, c * dt
        jacobian[THETA, GYRO] = -dt
        jacobian[U, V], jacobian[V, U] = turn * dt, -turn * dt
        jacobian[U, GYRO], jacobian[V, GYRO] = -v * dt, u * dt
        jacobian[U, FORCE_U] = jacobian[V, FORCE_V] = -dt
        jacobian[THETA, GYRO_SCALE] = -turn * dt
        jacobian[U, GYRO_SCALE], jacobian[V, GYRO_SCALE] = -turn * v * dt, turn * u * dt
        jacobian[U, FORCE_SCALE], jacobian[V, FORCE_SCALE] = -forward * dt, -left * dt
        noise = np.zeros(SIZE)
        noise[THETA] = self._imu.gyro_noise**2 * dt
        noise[[U, V]] = self._imu.force_noise**2 * dt
        noise[GYRO] = self._imu.gyro_bias_walk**2 * dt
        noise[[FORCE_U, FORCE_V]] = self._imu.force_bias_walk**2 * dt
        x[X] += dx
        x[Y] += dy
        x[THETA] = wrap(x[THETA] + turn * dt)
        x[U], x[V] = u + du, v + dv
        self.full_covariance = jacobian @ self.full_covariance @ jacobian.T + np.diag(noise)

    def correct(self, reading: DvlReading) -> None:
        """Take in a velocity of the log; scale errors of gyro and accelerometer."""
        x = self.state
        u, v = float(x[U]), float(x[V])
        c, s = math.cos(x[ANGLE]), math.sin(x[ANGLE])
        turned = np.array([c * u - s * v, s * u + c * v])
        gain = 1.0 + float(x[SCALE])
        jacobian = np.zeros((2, SIZE))
        jacobian[:, U], jacobian[:, V] = (gain * c, gain * s), (-gain * s, gain * c)
        jacobian[:, SCALE] = turned
        jacobian[:, ANGLE] = -gain * turned[1], gain * turned[0]
        jacobian[0, BIAS_U] = jacobian[1, BIAS_V] = 1.0
        expected = gain * turned + x[[BIAS_U, BIAS_V]]
        across = self.full_covariance @ jacobian.T
        spread = jacobian @ across + max(reading.std_m_s, 1e-6) ** 2 * np.eye(2)
        weight = np.linalg.solve(spread, across.T).T
        x += weight @ (np.array([reading.forward_m_s, reading.left_m_s]) - expected)
        x[THETA] = wrap(x[THETA])
        self.full_covariance -= weight @ across.T
        self.full_covariance = 0.5 * (self.full_covariance + self.full_covariance.T)
