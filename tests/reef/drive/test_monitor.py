import numpy as np
import pytest

from coral.reef.drive.monitor import MonitorCfg, PathMonitor, distance_to_path

PATH = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])


@pytest.mark.parametrize(
    ("point", "distance"), [((2.0, 1.0), 1.0), ((-3.0, 4.0), 5.0), ((5.0, 2.0), 1.0), ((4.0, 7.0), 3.0)]
)
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


def test_ticks_without_a_look_at_the_path_change_no_verdict():
    rng = np.random.default_rng(2)
    monitor, looks, verdicts = PathMonitor(MonitorCfg(deviation_m=1.0)), 0, set()
    monitor.follow(PATH, new_goal=True)
    point = np.array([0.0, 0.0])
    for _ in range(2000):
        point = np.clip(point + rng.normal(0.0, 0.05, 2), (0.0, -1.2), (4.0, 1.2))
        before = monitor._last
        left = monitor.left_path(*point)
        looks += monitor._last is not before
        assert left == (distance_to_path(PATH, *point) > 1.0)
        verdicts.add(left)
    assert verdicts == {False, True}
    assert looks < 1500


def test_a_new_path_is_looked_at():
    monitor = PathMonitor(MonitorCfg(deviation_m=1.0))
    monitor.follow(PATH, new_goal=True)
    assert not monitor.left_path(0.0, 0.0)
    monitor.follow(PATH + 3.0, new_goal=True)
    assert monitor.left_path(0.0, 0.0)
