import math

import numpy as np
import pytest

from coral.reef.mission.oracle import Tour, plan_tour
from coral.reef.simulation.imaging import ImagingCfg, ImagingMeter
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.collision import clearance
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene


def planned(world, visibility_m=None):
    return plan_tour(world, CameraCfg(), ImagingCfg(), visibility_m, VehicleCfg())


@pytest.fixture(scope="module")
def tour(pond):
    return planned(pond)


def test_the_tour_inspects_everything_and_touches_nothing(pond, tour):
    assert tour.inspected[-1] > 0.99
    footprints = Scene.from_world(pond).footprints()
    assert min(clearance(footprints, x, y) for x, y, _ in tour.poses) > 0.3
    assert tour.poses.min() > -math.pi


def test_its_curve_is_what_the_judge_would_count(pond, tour):
    judge = ImagingMeter(Scene.from_world(pond))
    shares = []
    for x, y, theta in tour.poses:
        judge.update(Pose(x, y, theta))
        shares.append(judge.inspected)
    np.testing.assert_allclose(tour.inspected, shares)
    assert tour.time_to(0.9) == pytest.approx(0.1 * next(k for k, s in enumerate(shares) if s >= 0.9))


def test_it_keeps_to_cruise_speed_and_yaw_rate(tour):
    vehicle = VehicleCfg()
    steps = np.hypot(*np.diff(tour.poses[:, :2], axis=0).T) / tour.dt
    turns = np.abs(np.remainder(np.diff(tour.poses[:, 2]) + math.pi, 2 * math.pi) - math.pi) / tour.dt
    assert steps.max() <= vehicle.max_speed_m_s + 1e-9
    assert turns.max() <= vehicle.max_yaw_rate_rad_s + 1e-9


def test_it_is_no_longer_than_a_walk_past_the_clusters_and_no_shorter_than_the_way_to_the_last(pond, tour):
    """Straight from the start to the far bed, less the range, is 9.1 m; past all three centres it is 14.4 m."""
    length = float(np.hypot(*np.diff(tour.poses[:, :2], axis=0).T).sum())
    assert math.dist((2.0, 3.0), (10.5, 9.5)) - 2.6 < length < 14.4


def test_in_murky_water_it_has_to_go_nearer(pond, tour):
    murky = planned(pond, 1.6)
    assert murky.time_to(0.9) > tour.time_to(0.9)


def test_times_of_a_tour_by_hand():
    made = Tour(np.zeros((3, 2)), np.zeros((4, 3)), np.array([0.0, 0.5, 0.85, 0.95]), (), 0.2)
    assert [made.time_to(s) for s in (0.5, 0.8, 0.9, 1.0)] == [0.2, 0.4, 0.6, None]
