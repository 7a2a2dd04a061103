import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.sea.local_frame import LocalFrame
from coral.reef.world.geometry import Pose, to_world

POSES = st.builds(Pose, st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3))


@given(POSES, POSES)
def test_the_reported_pose_becomes_the_start(reported, start):
    frame = LocalFrame.from_start(reported, start, trust_heading=False)
    found = frame.to_survey(reported)
    assert found[:2] == pytest.approx(start[:2], abs=1e-9)
    assert math.cos(found.theta - start.theta) == pytest.approx(1.0)


@given(POSES, POSES)
def test_what_lies_ahead_in_one_frame_lies_ahead_in_the_other(reported, start):
    frame = LocalFrame.from_start(reported, start, trust_heading=False)
    ahead = Pose(*to_world(reported, 2.0, 0.5), reported.theta)
    assert frame.to_survey(ahead)[:2] == pytest.approx(to_world(start, 2.0, 0.5), abs=1e-9)


def test_a_compass_heading_is_kept():
    frame = LocalFrame.from_start(Pose(100.0, 50.0, 1.0), Pose(2.0, 3.0, 0.0), trust_heading=True)
    assert frame.to_survey(Pose(101.0, 50.0, 1.0)) == pytest.approx((3.0, 3.0, 1.0))
