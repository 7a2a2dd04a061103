"""Beliefs with beds of oysters, for tests."""

import numpy as np

from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.chain import Component, InspectCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

CELL_M, EDGE = 0.05, 10


def bed(x, y):
    """A square of half a metre of oysters."""
    iy, ix = np.mgrid[:EDGE, :EDGE].reshape(2, -1)
    cells = np.stack([iy + round(y / CELL_M) - EDGE // 2, ix + round(x / CELL_M) - EDGE // 2], axis=1)
    return Component(x=x, y=y, area_px=len(cells), length_m=EDGE * CELL_M, cells=cells)


def belief_with(beds, pose=Pose(10.0, 10.0, 0.0), explored=None, size=(20.0, 20.0), inspect=True):  # noqa: B008
    """A robot at `pose` on an explored map with beds of which nothing has been seen from near."""
    belief = Belief(OccupancyMap(size, CameraCfg()), BeliefCfg(inspect=InspectCfg(enabled=inspect)))
    belief.pose, belief._trail = pose, [(pose.x, pose.y)]
    belief.map.explored[:] = True if explored is None else explored
    belief.tracker.update([bed(x, y) for x, y in beds])
    if inspect:
        belief._inspect()
    return belief


def see(belief, index, share=1.0):
    """Let the robot have seen a share of a bed from near."""
    track = belief.track(index)
    cells = track.cells[: round(share * len(track.cells))]
    belief.map.nearest[cells[:, 0], cells[:, 1]] = 1.0
    belief._inspect()
