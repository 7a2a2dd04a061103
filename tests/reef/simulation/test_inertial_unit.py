import dataclasses
import math

import numpy as np
import pytest

from coral.reef.simulation.inertial_unit import GRAVITY_M_S2, ImuCfg, SimulatedImu

EXACT = ImuCfg(**dict.fromkeys((field.name for field in dataclasses.fields(ImuCfg)), 0.0))


def unit(seed=0, **changes):
    return SimulatedImu(dataclasses.replace(EXACT, **changes), np.random.default_rng(seed))


def test_without_errors_it_tells_the_truth():
    felt = unit().measure(0.2, (0.1, -0.3), (0.01, 0.02), 0.1)
    assert dataclasses.astuple(felt) == (0.2, 0.1, -0.3, 0.01, 0.02)


def test_the_angle_walks_by_the_noise_of_the_gyro():
    """The integral of white noise of density N over t has a standard deviation of N √t, whatever the interval."""
    for dt, steps in ((0.1, 100), (0.5, 20)):
        units = [unit(seed, gyro_noise=0.01) for seed in range(300)]
        angles = [sum(each.measure(0.0, (0, 0), (0, 0), dt).turn_rad_s * dt for _ in range(steps)) for each in units]
        assert np.std(angles) == pytest.approx(0.01 * math.sqrt(10.0), rel=0.15)


@pytest.mark.parametrize(
    ("key", "of"),
    [
        ("gyro_bias_rad_s", lambda felt: felt.turn_rad_s),
        ("force_bias_m_s2", lambda felt: felt.forward_m_s2),
        ("gyro_scale", lambda felt: felt.turn_rad_s - 1.0),
        ("force_scale", lambda felt: felt.left_m_s2 - 1.0),
        ("tilt_bias_rad", lambda felt: felt.pitch_rad),
    ],
)
def test_an_error_of_a_dive_stays(key, of):
    units = [unit(seed, **{key: 0.01}) for seed in range(300)]
    truth = (1.0, (0.0, 1.0)) if key.endswith("scale") else (0.0, (0.0, 0.0))
    found = np.array([[of(each.measure(*truth, (0, 0), 0.1)) for _ in range(3)] for each in units])
    assert (found == found[:, :1]).all()
    assert np.std(found[:, 0]) == pytest.approx(0.01, rel=0.15)


def test_the_offset_of_the_gyro_wanders():
    units = [unit(seed, gyro_bias_walk=0.001) for seed in range(300)]
    for each in units:
        for _ in range(40):
            each.measure(0.0, (0, 0), (0, 0), 0.1)
    assert np.std([each.gyro_bias_rad_s for each in units]) == pytest.approx(0.002, rel=0.15)


def test_the_tilt_is_as_wrong_as_the_force_over_gravity_by_default():
    assert ImuCfg().tilt_bias_rad == pytest.approx(ImuCfg().force_bias_m_s2 / GRAVITY_M_S2, rel=0.05)
    assert unit(tilt_bias_rad=0.003, tilt_noise_rad=0.004).tilt_std_rad == pytest.approx(0.005)
