import numpy as np
import pytest

from coral.reef.monitor import MonitorCfg, PathMonitor, distance_to_path

PATH = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])


@pytest.mark.parametrize(("point", "distance"), [
    ((2.0, 1.0), 1.0), ((-3.0, 4.0), 5.0), ((5.0, 2.0), 1.0), ((4.0, 7.0), 3.0)])
def test_distance_to_a_polyline(point, distance):
    assert distance_to_path(PATH, *point) == pytest.approx(distance)


def test_no_path_no_deviation():
    assert distance_to_path(np.empty((0, 2)), 1.0, 2.0) == 0.0
    assert distance_to_path(np.array([[1.0, 1.0]]), 4.0, 5.0) == pytest.approx(5.0)


def test_leaving_the_path_is_noticed_and_replans_are_counted_per_goal():
    monitor = PathMonitor(MonitorCfg(deviation_m=1.0, max_replans=2))
    monitor.follow(PATH, new_goal=True)
    assert not monitor.left_path(2.0, 0.99)
    assert monitor.left_path(2.0, 1.01)
    monitor.follow(PATH, new_goal=False)
    assert not monitor.exhausted
    monitor.follow(PATH, new_goal=False)
    assert monitor.exhausted
    monitor.follow(PATH, new_goal=True)
    assert not monitor.exhausted
