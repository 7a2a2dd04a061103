import dataclasses
import math

import numpy as np
import pytest

from coral.reef.simulation.doppler_log import DvlCfg, SimulatedDvl

EXACT = DvlCfg(
    noise_m_s=0.0, bias_m_s=0.0, scale=0.0, misalignment_rad=0.0, altitude_scale=0.0, cycle_s=0.0, outage_rate_hz=0.0
)


def log(seed=0, **changes):
    return SimulatedDvl(dataclasses.replace(EXACT, **changes), np.random.default_rng(seed))


def readings(dvl, seconds, velocity=(0.5, 0.1), altitude_m=1.0, dt=0.1):
    return [dvl.measure(velocity, altitude_m, dt) for _ in range(round(seconds / dt))]


def test_without_errors_it_tells_the_truth():
    ping = log().measure((0.5, -0.1), 1.2, 0.0)
    assert (ping.forward_m_s, ping.left_m_s, ping.altitude_m, ping.std_m_s) == (0.5, -0.1, 1.2, 0.0)


def test_noise_is_as_large_as_the_figure_of_merit_says():
    found = readings(log(noise_m_s=0.02), 200.0)
    assert found[0].std_m_s == 0.02
    assert np.std([ping.forward_m_s for ping in found]) == pytest.approx(0.02, rel=0.1)
    assert np.std([ping.left_m_s for ping in found]) == pytest.approx(0.02, rel=0.1)


@pytest.mark.parametrize(
    ("key", "sigma", "error"),
    [
        ("scale", 0.01, lambda ping: ping.forward_m_s / 0.5 - 1.0),
        ("bias_m_s", 0.001, lambda ping: ping.forward_m_s - 0.5),
        ("misalignment_rad", 0.01, lambda ping: math.atan2(ping.left_m_s, ping.forward_m_s)),
        ("altitude_scale", 0.01, lambda ping: ping.altitude_m - 1.0),
    ],
)
def test_an_error_of_a_dive_stays_and_differs_from_dive_to_dive(key, sigma, error):
    dives = [[error(ping) for ping in readings(log(seed, **{key: sigma}), 0.3, (0.5, 0.0))] for seed in range(300)]
    assert all(dive == pytest.approx([dive[0]] * 3) for dive in dives)
    assert np.std([dive[0] for dive in dives]) == pytest.approx(sigma, rel=0.15)


def test_it_pings_at_its_rate():
    dvl = log(rate_hz=5.0)
    assert dvl.measure((0.5, 0.0), 1.0, 0.0) is not None
    assert [ping is not None for ping in readings(dvl, 0.6)] == [False, True, False, True, False, True]


def test_it_checks_its_bottom_lock_every_ten_seconds():
    lost = [k for k, ping in enumerate(readings(log(cycle_s=10.0, cycle_lost_s=0.2), 25.0), 1) if ping is None]
    assert lost == [100, 101, 200, 201]


def test_bottom_lock_gets_lost_as_often_and_as_long_as_configured():
    found = readings(log(3, outage_rate_hz=0.05, outage_s=2.0), 2000.0)
    lost = np.array([ping is None for ping in found])
    assert lost.mean() == pytest.approx(1.0 - math.exp(-0.1), rel=0.35)  # an M/M/∞ queue that is not empty


@pytest.mark.parametrize("altitude_m", [0.0, 51.0])
def test_out_of_range_there_is_no_bottom(altitude_m):
    assert log().measure((0.5, 0.0), altitude_m, 0.1) is None
