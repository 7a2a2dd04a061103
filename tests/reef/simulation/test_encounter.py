import numpy as np

from coral.reef.simulation.encounter import Encounters


def test_a_contact_of_two_robots_counts_once_until_they_have_parted():
    watch, away = Encounters(radius_m=0.3), (9.0, 9.0)
    near = [(0.0, 0.0), (0.59, 0.0), away]
    assert watch.follow(1, np.array([(1.0, 0.0), (0.59, 0.0)]), near) == [(0.59, 0.0, 0)]
    assert watch.follow(0, np.array([(0.0, 0.0)]), near) == []
    assert watch.follow(1, np.array([(0.62, 0.0), (0.58, 0.0)]), near) == []
    assert watch.follow(1, np.array([(0.58, 0.0), (0.70, 0.0)]), near) == []
    assert watch.follow(1, np.array([(0.70, 0.0), (0.60, 0.0)]), near) == [(0.60, 0.0, 0)]
    assert watch.count == 2


def test_robots_apart_do_not_touch():
    assert Encounters(radius_m=0.3).follow(0, np.array([(0.0, 0.0), (1.0, 0.0)]), [(1.0, 0.0), (1.0, 0.61)]) == []
