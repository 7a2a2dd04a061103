"""The best colour picture of each cluster."""

import numpy as np

from coral.reef.map.best_views import BestViews
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose

CAMERA = CameraCfg()
SHAPE = (CAMERA.height, CAMERA.width)


class Cluster:
    def __init__(self, x, y):
        self.x, self.y = x, y


def frame(colour, depth=12.0):
    still = np.full((960, 1280, 3), colour, np.uint8)
    return Frame(
        np.full(SHAPE, depth, np.float32), np.zeros(SHAPE, np.uint8), np.zeros(SHAPE, np.int32), still=lambda: still
    )


def test_a_nearer_picture_replaces_the_old_one_but_none_that_shows_only_a_part():
    thing, views = Cluster(10.0, 5.0), BestViews(CAMERA)
    for tick, (x, colour) in enumerate([(4.0, 10), (7.0, 20), (5.0, 30), (9.2, 40)]):
        views.update(frame(colour), Pose(x, 5.0, 0.0), [thing], tick)
    ((_, view, age_s),) = views.of([thing])
    assert (view.distance_m, round(age_s, 1), int(view.crop[0, 0, 0])) == (3.0, 0.2, 20)


def test_what_is_behind_hidden_or_at_the_edge_has_no_picture():
    thing, views = Cluster(10.0, 5.0), BestViews(CAMERA)
    views.update(frame(10), Pose(12.0, 5.0, 0.0), [thing], 0)
    views.update(frame(10, depth=2.0), Pose(6.0, 5.0, 0.0), [thing], 0)
    views.update(frame(10), Pose(9.5, 1.0, 0.0), [thing], 0)
    assert views.of([thing]) == []
