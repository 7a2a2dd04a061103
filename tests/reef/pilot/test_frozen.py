"""A camera that hangs."""

import numpy as np

from coral.reef.pilot.frozen import FrozenCamera
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Frame, Label


def picture(label=Label.OYSTER, depth=5.0):
    return Frame(np.full((6, 8), depth, np.float32), np.full((6, 8), label, np.uint8), np.zeros((6, 8), np.int32))


def hangs(frames, velocity):
    camera = FrozenCamera(way_m=0.05, turn_rad=0.05)
    return [camera.update(Stamped(k / 10, frame), velocity) for k, frame in enumerate(frames)]


def test_the_same_oyster_from_a_moving_vehicle_is_frozen():
    assert hangs([picture()] * 4, (0.3, 0.0, 0.0)) == [False, False, True, True]
    assert hangs([picture()] * 4, (0.0, 0.3, 0.0)) == [False, False, True, True]
    assert hangs([picture()] * 4, (0.0, 0.0, -0.3)) == [False, False, True, True]


def test_a_standing_vehicle_sees_the_same_again():
    assert not any(hangs([picture()] * 50, (0.0, 0.0, 0.0)))


def test_bare_seabed_may_look_the_same_everywhere():
    assert not any(hangs([picture(Label.SEABED)] * 50, (0.6, 0.0, 0.0)))


def test_a_new_picture_ends_it():
    frames = [picture()] * 4 + [picture(depth=4.9)] * 2
    assert hangs(frames, (0.3, 0.0, 0.0)) == [False, False, True, True, False, False]
