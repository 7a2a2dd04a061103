import math

import numpy as np
import pytest

from coral.reef.ros import ros_link
from coral.reef.ros.ros_link import covariance_of, frame_fault, pose_of, velocity_of
from coral.reef.sea.link import LinkRefused
from coral.ros.ros_node import OtherClockError
from reef.ros.fake_ros import FakeNode, fake_type, message, odometry


@pytest.fixture
def node(monkeypatch):
    monkeypatch.setattr(ros_link, "ros_type", fake_type)
    return FakeNode()


@pytest.fixture
def link(node):
    made = ros_link.RosLink(node=node)
    node.heard["odom"](odometry())
    return made


def twists(node):
    return [(m.linear.x, m.linear.z, m.angular.z) for topic, m in node.sent if topic == "cmd_vel"]


def test_odometry_is_the_report(link):
    report = link.report()
    assert report.pose == pytest.approx((1.0, 2.0, 0.0))
    assert report.depth_m == 1.5
    assert report.has_position
    assert report.velocity == (0.3, 0.0, 0.1)
    assert not report.armed
    assert report.identity_faults == ()


def test_battery_of_nan_is_not_told(link, node):
    node.heard["battery"](message(voltage=15.2, percentage=math.nan))
    assert (link.report().battery_v, link.report().battery_fraction) == (15.2, None)


def test_an_old_message_that_comes_late_changes_nothing(link, node):
    node.heard["odom"](odometry(x=9.0, stamp=4.0))
    assert link.report().pose.x == 1.0


def test_stamps_of_another_clock_are_no_position(link, node):
    node.heard["odom"](odometry(stamp=OtherClockError("stamps are +40.0 s behind this clock")))
    report = link.report()
    assert not report.has_position
    assert "behind this clock" in report.identity_faults[0]


def test_a_second_sender_of_odometry_or_of_commands_is_named(link, node):
    node.publishers = {"odom": 2, "cmd_vel": 3}
    assert link.report().identity_faults == ("2 nodes publish odom", "2 other nodes may publish cmd_vel")


def test_nothing_is_sent_before_arming(link, node):
    link.command(0.5, 0.1, 1.5)
    assert twists(node) == []


def test_a_setpoint_drives_and_holds_the_depth(link, node):
    link.arm()
    link.command(0.5, 0.1, 1.3)  # 0.2 m higher
    assert twists(node) == [(0.5, pytest.approx(0.1), 0.1)]


def test_numbers_that_are_not_finite_stop_it(link, node):
    link.arm()
    link.command(math.nan, 0.1, 1.5)
    assert twists(node)[-1] == (0.0, 0.0, 0.0)


def test_a_program_that_falls_silent_stops_the_vehicle(link, node, monkeypatch):
    link.arm()
    link.command(0.5, 0.0, 1.5)
    monkeypatch.setattr(ros_link, "SILENT_S", -1.0)
    node.timers[0]()
    assert twists(node)[-1] == (0.0, 0.0, 0.0)


def test_a_hold_goes_on_being_sent_and_an_ascent_rises(link, node):
    link.arm()
    link.hold()
    node.timers[0]()
    assert twists(node)[-1] == (0.0, 0.0, 0.0)
    link.surface()
    node.timers[0]()
    assert twists(node)[-1] == (0.0, ros_link.CLIMB_M_S, 0.0)


def test_it_is_refused_where_nobody_listens_or_the_service_says_no(link, node):
    node.arms = lambda armed: (False, "leak")
    with pytest.raises(LinkRefused, match="leak"):
        link.arm()
    node.subscribers = 0
    with pytest.raises(LinkRefused, match="nobody listens"):
        link.arm()


def test_somebody_who_begins_to_command_has_taken_over(link, node):
    link.arm()
    node.publishers["cmd_vel"] = 2
    assert link.report().manual_override


def test_the_end_stops_the_vehicle(link, node):
    link.arm()
    link.command(0.5, 0.0, 1.5)
    link.close()
    assert twists(node)[-1] == (0.0, 0.0, 0.0)
    assert node.closed


def test_heading_is_counter_clockwise_from_east():
    pose, z, roll, pitch = pose_of(odometry(yaw_half=(math.sin(math.pi / 4), math.cos(math.pi / 4))))
    assert pose == pytest.approx((1.0, 2.0, math.pi / 2))
    assert (z, roll, pitch) == pytest.approx((-1.5, 0.0, 0.0))


@pytest.mark.parametrize("broken", [{"x": math.nan}, {"yaw_half": (0.0, 0.0)}, {"z": math.inf}])
def test_a_pose_that_is_none_counts_as_none(broken):
    assert pose_of(odometry(**broken)) is None


def test_a_velocity_that_is_not_finite_counts_as_none():
    assert velocity_of(odometry(speed=math.nan)) is None
    assert velocity_of(odometry(speed=0.25)) == (0.25, 0.0, 0.1)


@pytest.mark.parametrize("frame", ["odom_ned", "world_NED", "base-frd"])
def test_frames_of_other_conventions_are_told(frame):
    assert "REP-103" in frame_fault(odometry(frame=frame))


def test_frames_whose_names_merely_hold_the_letters_are_not():
    assert frame_fault(odometry(frame="aligned_odom")) == ""


def test_a_covariance_of_zeros_is_not_told():
    assert covariance_of(odometry()) is None
    np.testing.assert_allclose(covariance_of(odometry(cov=0.04)), np.diag([0.04] * 3))
