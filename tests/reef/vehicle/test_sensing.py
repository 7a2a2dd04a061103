"""The record of one control period."""

import numpy as np

from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.world.geometry import Frame, Pose


def test_a_simulator_stamps_everything_with_the_same_moment():
    frame = Frame(np.ones((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.zeros((2, 2), np.int32))
    seen = VehicleObservation.at(1.5, Pose(1.0, 2.0, 0.0), (0.1, 0.0, 0.0), frame)
    assert seen.pose == Stamped(1.5, Pose(1.0, 2.0, 0.0))
    assert {seen.t, seen.velocity.t, seen.frame.t} == {1.5}
    assert seen.covariance is None
    assert seen.attitude is None
