import math

import numpy as np
import pytest

from coral.reef.simulation.doppler_log import DvlCfg, DvlReading
from coral.reef.simulation.inertial_filter import InertialFilter
from coral.reef.simulation.inertial_unit import ImuCfg, ImuReading
from coral.reef.world.geometry import Pose

AT = np.array([1.0, 2.0, 0.7, 0.5, 0.1, 0.01, 0.02, -0.03, 0.01, 0.02, 0.003, 0.004, 0.005, 0.006])
REST = ImuReading(0.0, 0.0, 0.0, 0.0, 0.0)
EXACT = ImuCfg(
    gyro_noise=0.0,
    gyro_bias_rad_s=0.0,
    gyro_bias_walk=0.0,
    force_noise=0.0,
    force_bias_m_s2=0.0,
    gyro_scale=0.0,
    force_scale=0.0,
)
EXACT_LOG = DvlCfg(noise_m_s=0.0, bias_m_s=0.0, scale=0.0, misalignment_rad=0.0)


def dead_reckoning(imu=EXACT, dvl=EXACT_LOG, start=Pose(0.0, 0.0, 0.0)):  # noqa: B008
    return InertialFilter(start, imu, dvl)


def ping(forward, left=0.0, std=0.01):
    return DvlReading(forward, left, 1.0, std)


def test_it_integrates_force_and_turn():
    """1 m/s² for a second along a heading of 90 degrees: 0.5 m north; then a turn to the left."""
    filter_ = dead_reckoning(start=Pose(2.0, 3.0, math.pi / 2))
    for _ in range(10):
        filter_.predict(ImuReading(0.0, 1.0, 0.0, 0.0, 0.0), 0.1)
    assert filter_.pose == pytest.approx(Pose(2.0, 3.5, math.pi / 2))
    assert filter_.velocity == pytest.approx((1.0, 0.0))
    filter_.predict(ImuReading(0.3, 0.0, 0.3, 0.0, 0.0), 0.1)  # 0.3 m/s² to the left keep it on its circle
    assert filter_.pose.theta == pytest.approx(math.pi / 2 + 0.03)
    assert filter_.velocity == pytest.approx((1.0, 0.0), abs=0.01)


def test_the_log_corrects_the_velocity_by_its_figure_of_merit():
    imu = ImuCfg(force_noise=1.0)
    good, poor = dead_reckoning(imu), dead_reckoning(imu)
    for filter_, std in ((good, 0.001), (poor, 10.0)):
        filter_.predict(REST, 0.1)
        filter_.correct(ping(0.5, 0.2, std))
    assert good.velocity == pytest.approx((0.5, 0.2), abs=0.001)
    assert poor.velocity == pytest.approx((0.0, 0.0), abs=0.001)


def test_a_scale_error_makes_the_position_uncertain_by_its_share_of_the_way():
    filter_ = dead_reckoning(ImuCfg(gyro_noise=0.0, force_noise=1.0), DvlCfg(
        noise_m_s=0.001, bias_m_s=0.0, scale=0.01, misalignment_rad=0.0))  # fmt: skip
    for k in range(410):
        filter_.predict(ImuReading(0.0, 0.5 if k < 10 else 0.0, 0.0, 0.0, 0.0), 0.1)
        filter_.correct(ping(min(0.05 * (k + 1), 0.5), std=0.001))
    assert filter_.pose.x == pytest.approx(20.25, rel=0.02)
    assert math.sqrt(filter_.covariance[0, 0]) == pytest.approx(0.2, rel=0.1)


def test_without_the_log_the_doubt_grows_ever_faster():
    filter_ = dead_reckoning(ImuCfg(), DvlCfg())
    sigma = []
    for _ in range(4):
        for _ in range(50):
            filter_.predict(REST, 0.1)
        sigma.append(math.sqrt(filter_.covariance[0, 0]))
    assert np.all(np.diff(sigma, 2) > 0.0)
    offset, start = 0.5 * 0.05 * 5.0**2, 0.1 * 5.0  # the accelerometer's offset, integrated twice; the first velocity
    assert sigma[0] == pytest.approx(math.hypot(offset, start), rel=0.05)


def test_the_jacobian_is_the_derivative_of_the_prediction():
    """Twin: the covariance of a small error, by finite differences of the prediction itself."""
    reading = ImuReading(0.4, 0.3, -0.2, 0.0, 0.0)

    def predicted(error):
        filter_ = dead_reckoning()
        filter_.state[:] = (
            np.array([1.0, 2.0, 0.7, 0.5, 0.1, 0.01, 0.02, -0.03, 0.01, 0.02, 0.003, 0.004, 0.005, 0.006]) + error
        )
        filter_.predict(reading, 0.1)
        return filter_.state.copy()

    step = 1e-6
    twin = np.stack([(predicted(step * e) - predicted(-step * e)) / (2 * step) for e in np.eye(14)], axis=1)
    filter_ = dead_reckoning()
    filter_.state[:] = AT
    filter_.full_covariance = np.eye(14)
    filter_.predict(reading, 0.1)
    assert filter_.full_covariance == pytest.approx(twin @ twin.T, abs=6e-3)  # second order in dt is left out
