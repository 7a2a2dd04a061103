"""A sensor that hangs."""

import operator

from coral.reef.pilot.frozen import FrozenSensor
from coral.reef.vehicle.sensing import Stamped


def hangs(measured, velocity):
    sensor = FrozenSensor(operator.eq, way_m=0.05, turn_rad=0.05)
    return [sensor.update(Stamped(k / 10, one), velocity) for k, one in enumerate(measured)]


def test_the_same_again_from_a_moving_vehicle_is_frozen():
    assert hangs("aaaa", (0.3, 0.0, 0.0)) == [False, False, True, True]
    assert hangs("aaaa", (0.0, 0.3, 0.0)) == [False, False, True, True]
    assert hangs("aaaa", (0.0, 0.0, -0.3)) == [False, False, True, True]


def test_a_standing_vehicle_sees_the_same_again():
    assert not any(hangs("a" * 50, (0.0, 0.0, 0.0)))


def test_something_new_ends_it():
    assert hangs("aaaabb", (0.3, 0.0, 0.0)) == [False, False, True, True, False, False]
