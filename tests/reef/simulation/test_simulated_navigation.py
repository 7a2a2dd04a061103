import dataclasses

import numpy as np
import pytest
from true_tracks import LEVEL, wander

from coral.reef.simulation.depth_sensor import DepthSensorCfg
from coral.reef.simulation.doppler_log import DvlCfg
from coral.reef.simulation.inertial_unit import ImuCfg
from coral.reef.simulation.simulated_navigation import NavigationCfg, SimulatedNavigation
from coral.reef.world.geometry import Pose, wrap

START = Pose(0.0, 0.0, 0.0)


def zeroed(cfg, **changes):
    numbers = {field.name: 0.0 for field in dataclasses.fields(cfg) if field.name != "rate_hz"}
    return dataclasses.replace(cfg, **{**numbers, **changes})


EXACT = NavigationCfg(
    source="dvl-imu",
    dvl=zeroed(DvlCfg(), outage_rate_hz=0.0, outage_s=1.0, range_m=50.0),
    imu=zeroed(ImuCfg()),
    depth=zeroed(DepthSensorCfg()),
)


def navigated(seconds, cfg=NavigationCfg(source="dvl-imu"), seed=0):  # noqa: B008
    """True poses and fixes along a track."""
    navigation = SimulatedNavigation(cfg, START, np.random.default_rng(seed))
    for k, (pose, velocity) in enumerate(wander(seconds, seed)):
        yield pose, navigation.step(pose, velocity, LEVEL, 0.1 if k else 0.0)


def test_with_exact_sensors_it_is_where_it_thinks():
    for pose, fix in navigated(30.0, EXACT):
        assert fix.pose == pytest.approx(pose, abs=2e-3)  # straight chords of arcs
        assert (fix.attitude.depth_m, fix.attitude.roll) == (4.0, 0.0)
    assert pose.x != 0.0


def test_its_error_is_as_large_as_its_covariance_says():
    """The normalized squared error of a consistent filter is 3 in the mean; 20 dives give it within 1.6."""
    squares = []
    for seed in range(20):
        *_, (pose, fix) = navigated(30.0, seed=seed)
        error = np.array([fix.pose.x - pose.x, fix.pose.y - pose.y, wrap(fix.pose.theta - pose.theta)])
        squares.append(error @ np.linalg.solve(fix.covariance, error))
    assert 1.4 < np.mean(squares) < 4.6


def test_the_same_seed_gives_the_same_dive_and_another_another():
    ends = [[*navigated(5.0, seed=seed)][-1][1].pose for seed in (1, 1, 2)]
    assert ends[0] == ends[1] != ends[2]


def test_the_velocity_grows_old_without_bottom_lock():
    lost = dataclasses.replace(NavigationCfg().dvl, range_m=0.5)  # the floor is 1 m away
    fixes = [fix for _, fix in navigated(1.0, NavigationCfg(source="dvl-imu", dvl=lost))]
    assert [round(fix.velocity_age_s, 6) for fix in fixes[:3]] == [0.0, 0.1, 0.2]
    assert fixes[-1].attitude.altitude_m is None
    kept = [fix for _, fix in navigated(1.0)]
    assert kept[-1].velocity_age_s == 0.0
    assert fixes[-1].covariance[0, 0] > kept[-1].covariance[0, 0]


def test_attitude_says_how_good_it_is():
    fixes = [fix for _, fix in navigated(20.0, seed=3)]
    first = fixes[-1].attitude
    assert first.tilt_std_rad == pytest.approx(0.0054, abs=1e-4)
    assert first.depth_std_m == pytest.approx(0.0206, abs=1e-4)
    assert abs(np.mean([fix.attitude.roll for fix in fixes])) < 4 * first.tilt_std_rad
    assert first.depth_m != 4.0
