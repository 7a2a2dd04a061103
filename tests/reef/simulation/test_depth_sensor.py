import numpy as np
import pytest

from coral.reef.simulation.depth_sensor import DepthSensorCfg, SimulatedDepthSensor


def sensor(seed=0, **cfg):
    return SimulatedDepthSensor(DepthSensorCfg(**{"noise_m": 0.0, "offset_m": 0.0, **cfg}), np.random.default_rng(seed))


def test_depths_come_in_steps():
    assert sensor().measure(1.2345) == pytest.approx(1.234)
    assert sensor(resolution_m=0.0).measure(1.2345) == 1.2345


def test_noise_differs_from_depth_to_depth_and_the_offset_from_dive_to_dive():
    noisy = sensor(noise_m=0.01)
    assert np.std([noisy.measure(2.0) for _ in range(500)]) == pytest.approx(0.01, rel=0.15)
    dives = [sensor(seed, offset_m=0.02) for seed in range(300)]
    found = np.array([[dive.measure(2.0) for _ in range(2)] for dive in dives])
    assert (found[:, 0] == found[:, 1]).all()
    assert np.std(found[:, 0]) == pytest.approx(0.02, rel=0.15)
