"""Colour pictures of the way."""

import numpy as np

from coral.reef.map.glimpses import MOST, PICTURE_PX, Glimpses
from coral.reef.world.geometry import Frame, Pose

SHAPE = (120, 160)


def frame(colour=0):
    still = np.full((960, 1280, 3), colour, np.uint8)
    flat = (np.full(SHAPE, 3.0, np.float32), np.zeros(SHAPE, np.uint8), np.zeros(SHAPE, np.int32))
    return Frame(*flat, still=lambda: still)


def kept(*poses):
    glimpses = Glimpses()
    for k, pose in enumerate(poses):
        glimpses.update(frame(k), Pose(*pose))
    return glimpses.kept


def test_a_picture_is_kept_where_the_robot_has_gone_on_or_turned():
    found = kept((0, 0, 0), (1, 0, 0), (2.6, 0, 0), (2.6, 0, 0.3), (2.6, 0, 1.0), (0.1, 0, 0))
    assert [one.pose for one in found] == [(0, 0, 0), (2.6, 0, 0), (2.6, 0, 1.0)]
    assert found[1].picture.shape == (360, PICTURE_PX, 3)
    assert found[1].picture[0, 0, 0] == 2


def test_there_are_never_more_than_so_many_and_the_ends_of_the_way_stay():
    found = kept(*((3.0 * k, 0, 0) for k in range(2 * MOST)))
    assert len(found) == MOST
    assert found[-1].pose.x == 3.0 * (2 * MOST - 1)


def test_without_colours_there_is_nothing_to_keep():
    glimpses = Glimpses()
    glimpses.update(
        Frame(np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.uint8), np.zeros(SHAPE, np.int32)), Pose(0, 0, 0)
    )
    assert glimpses.kept == ()
