"""Observations that no vehicle makes, for the tests of what must survive them."""

import numpy as np
from hypothesis import strategies as st

from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Attitude, Stamped, VehicleObservation
from coral.reef.world.geometry import Frame, Pose

ANY = st.one_of(
    st.none(), st.text(max_size=3), st.floats(), st.integers(-3, 3), st.binary(max_size=3),
    st.tuples(st.floats(), st.floats(), st.floats()), st.lists(st.floats(-30.0, 30.0), max_size=4),
)  # fmt: skip


@st.composite
def frames(draw, height, width):
    """Pictures, some of them of the right size and type."""
    shape = draw(st.sampled_from([(height, width), (height, width), (width, height), (1, 1), (0, 8), (480, 640)]))
    depths, labels = draw(st.sampled_from([np.float32, np.float64])), draw(st.sampled_from([np.uint8, np.int32]))
    depth = np.full(shape, draw(st.floats(width=32)), depths)
    if depth.size:
        depth[0, : draw(st.integers(0, 3))] = draw(st.floats(width=32))
    return Frame(depth, np.full(shape, draw(st.integers(0, 5)), labels), np.full(shape, -1, np.int32))


@st.composite
def range_images(draw):
    """Range images, some of them of a sonar with 4 rows and 8 columns."""
    shape = draw(st.sampled_from([(4, 8), (4, 8), (8, 4), (0, 8), (1, 1)]))
    ranges = np.full(shape, draw(st.floats(width=32)), draw(st.sampled_from([np.float32, np.float64])))
    if ranges.size:
        ranges[0, 0] = draw(st.floats(width=32))
    return RangeImage(draw(st.one_of(st.just(ranges), ANY)), draw(st.one_of(st.just(90.0), ANY)), 40.0)


def observations(t, height, width):
    """Observations at about time `t` (s) of a vehicle in a survey area of 20 m, in part good, in part not."""
    times = st.one_of(st.just(t), st.floats(t - 1.0, t + 1.0), st.floats(), st.none())

    def stamped(value):
        return st.one_of(st.none(), ANY, st.builds(Stamped, times, value), st.builds(Stamped, times, ANY))

    return st.builds(
        VehicleObservation,
        t=st.one_of(st.just(t), st.just(t), times),
        pose=stamped(st.builds(Pose, *[st.floats(-5.0, 25.0)] * 3)),
        velocity=stamped(st.tuples(*[st.floats(-2.0, 2.0)] * 3)),
        frame=stamped(frames(height, width)),
        covariance=st.one_of(st.none(), ANY, st.just(np.eye(3))),
        attitude=stamped(st.builds(Attitude, roll=ANY, pitch=st.floats(), depth_m=st.floats())),
        sonar=stamped(range_images()),
    )
