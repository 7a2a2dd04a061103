import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.decide.verify import (
    Surroundings,
    VerifyCfg,
    behind_previous,
    behind_robot,
    deviated,
    reference,
    verify_waypoint,
)
from coral.reef.world.geometry import Pose

CFG = VerifyCfg()
EAST = Pose(10.0, 10.0, 0.0)


def at(bearing_deg, distance=4.0, pose=EAST):
    angle = pose.theta + math.radians(bearing_deg)
    return pose.x + distance * math.cos(angle), pose.y + distance * math.sin(angle)


def around(pose=EAST, previous=None, ahead=(), chain=(), dead_end=False):
    return Surroundings(pose=pose, previous=previous, ahead=ahead, chain=chain, dead_end=dead_end)


@pytest.mark.parametrize(("bearing", "rejected"), [(0, False), (119, False), (-119, False), (121, True), (180, True)])
def test_equation_4_behind_robot(bearing, rejected):
    assert behind_robot(at(bearing), EAST, CFG) is rejected


def test_equation_5_behind_previous_target():
    previous = (14.0, 10.0)
    assert behind_previous((12.0, 10.5), EAST, previous, CFG)  # between robot and previous target
    assert not behind_previous((16.0, 10.0), EAST, previous, CFG)  # beyond it
    assert not behind_previous((14.0, 14.0), EAST, previous, CFG)  # to its side
    assert not behind_previous((8.5, 10.0), EAST, previous, CFG)  # farther than d_exempt: 5.5 m
    assert not behind_previous((12.0, 10.5), EAST, None, CFG)


def test_equation_7_prefers_the_farthest_centroid_in_the_corridor():
    ahead = [at(0, 2.0), at(10, 6.0), at(60, 9.0)]
    found = reference(around(ahead=ahead, chain=ahead), CFG)
    assert found is not None
    assert found[1] == ahead[1]


def test_equation_7_falls_back_on_the_chain_behind():
    found = reference(around(chain=[at(180, 4.0), at(170, 2.0)]), CFG)
    assert found is not None
    trend, centroid = found
    assert centroid is None
    assert trend == pytest.approx((4.0, 0.0))


def test_equation_8_with_sign_and_exemptions():
    ahead = [at(0, 5.0)]
    chain = [*ahead, at(180, 2.0), at(180, 5.0)]
    world = around(ahead=ahead, chain=chain)
    assert deviated(at(59), world, CFG) is None
    left = deviated(at(70), world, CFG)
    assert left is not None
    assert math.degrees(left) == pytest.approx(70)
    right = deviated(at(-70), world, CFG)
    assert right is not None
    assert math.degrees(right) == pytest.approx(-70)
    assert deviated(at(70), around(ahead=ahead, chain=chain[:2]), CFG) is None  # too little is known yet
    sideways = [at(65, 3.0)]
    assert deviated(sideways[0], around(ahead=sideways, chain=[*sideways, *chain[1:]]), CFG) is None  # coincides


def test_reasons_name_the_failure_and_the_side():
    chain = [at(0, 5.0), at(180, 2.0), at(180, 5.0)]
    world = around(ahead=chain[:1], chain=chain)
    behind = verify_waypoint(at(180), world, CFG)
    assert behind is not None
    assert behind.code == "behind-robot"
    aside = verify_waypoint(at(80), world, CFG)
    assert aside is not None
    assert aside.code == "deviation"
    assert "to the left" in aside.reason


def test_dead_end_allows_turning_round():
    assert verify_waypoint(at(180), around(dead_end=True), CFG) is None


@given(st.floats(-10, 10), st.floats(-10, 10), st.floats(-math.pi, math.pi))
def test_what_is_ahead_is_accepted_and_what_is_behind_only_where_nothing_is_ahead(dx, dy, theta):
    pose = Pose(dx, dy, theta)
    dots = [at(0, 5.0, pose)]
    for ahead in (dots, []):
        assert verify_waypoint(at(0, 3.0, pose), around(pose=pose, ahead=ahead), CFG) is None
        assert (verify_waypoint(at(180, 3.0, pose), around(pose=pose, ahead=ahead), CFG) is None) is (ahead == [])
