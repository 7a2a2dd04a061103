"""From messages to a report: frames, stamps, and what must not change it."""

import math

import pytest
from messages import attitude, estimator, heartbeat, height, mavlink, position, sent, text

from coral.reef.sea.telemetry import Telemetry


def told(*messages, system=1):
    telemetry = Telemetry(system)
    for k, message in enumerate(messages):
        telemetry.take(message, 100.0 + 0.1 * k)
    return telemetry


def test_a_pose_in_our_frames():
    telemetry = told(
        heartbeat(), estimator(), attitude(1000, yaw=math.pi / 2, turn=0.3), position(1000, north=3.0, east=4.0, ve=0.5)
    )
    report = telemetry.report(100.5)
    assert report.pose == pytest.approx((4.0, 3.0, 0.0), abs=1e-6)
    assert report.velocity == pytest.approx((0.5, 0.0, -0.3), abs=1e-6)
    assert (report.roll_rad, report.pitch_rad) == pytest.approx((0.1, -0.2))
    assert report.position_test_ratio == pytest.approx(0.2)
    assert (report.mode, report.armed) == ("GUIDED", True)
    assert report.heartbeat_age_s == pytest.approx(0.5)


def test_without_an_estimate_positions_are_no_poses_and_stamps_stand_still():
    telemetry = told(heartbeat(), estimator(167), attitude(1000), position(1000))
    assert telemetry.report(101.0).pose is None
    telemetry = told(heartbeat(), estimator(), attitude(1000), position(1000), estimator(37), position(1300))
    report = telemetry.report(101.0)
    assert not report.has_position
    assert report.pose_stamp_s == pytest.approx(100.2)


def test_a_late_packet_has_an_old_stamp_and_does_not_replace_a_newer_one():
    telemetry = told(heartbeat(), estimator(), attitude(1000), position(1000, north=1.0))
    telemetry.take(position(1100, north=2.0), 100.9)
    assert telemetry.report(101.0).pose_stamp_s == pytest.approx(100.3)
    telemetry.take(position(1050, north=9.0), 100.95)
    assert telemetry.report(101.0).pose.y == pytest.approx(2.0)


def test_a_height_above_the_floor_is_dropped_when_it_is_old_but_its_stamp_stays():
    telemetry = told(heartbeat(), height(140), height(300, looks=0), height(9, least=20))
    assert (telemetry.report(100.5).altitude_m, telemetry.report(101.2).altitude_m) == (pytest.approx(1.4), None)
    assert telemetry.report(101.2).altitude_stamp_s == pytest.approx(100.1)


def test_other_vehicles_and_components_do_not_speak_for_ours():
    telemetry = told(
        heartbeat(), heartbeat(mode=0, armed=False, system=2), heartbeat(mode=0, armed=False, component=197)
    )
    assert telemetry.report(101.0).mode == "GUIDED"
    assert told(heartbeat(system=1), heartbeat(mode=2, system=7), system=7).report(101.0).mode == "ALT_HOLD"


def test_numbers_that_are_not_finite_are_refused():
    telemetry = told(heartbeat(), estimator(), attitude(1000), position(1000), position(1100, north=math.nan))
    assert telemetry.report(101.0).pose == pytest.approx((0.0, 0.0, math.pi / 2), abs=1e-6)


def test_texts_come_once_and_long_ones_whole():
    telemetry = told(
        heartbeat(), text("a" * 50, number=7, chunk=0), text("bc", number=7, chunk=1), text("Leak Detected", 2)
    )
    report = telemetry.report(101.0)
    assert [t.text for t in report.texts] == ["a" * 50 + "bc", "Leak Detected"]
    assert report.leak
    assert telemetry.report(101.0).texts == ()
    assert telemetry.report(101.0).leak


def test_control_characters_do_not_reach_the_terminal():
    assert told(heartbeat(), text("a\x1b[2Jb")).report(101.0).texts[0].text == "a[2Jb"


def test_tether_turns_are_counted_through_the_wrap():
    angles = [0.0, 2.0, 4.0, 6.0, 8.0]
    telemetry = told(
        heartbeat(), *[attitude(1000 + 100 * k, yaw=math.remainder(a, math.tau)) for k, a in enumerate(angles)]
    )
    assert telemetry.report(101.0).tether_turns == pytest.approx(-8.0 / math.tau)


def test_battery_and_unknown_battery():
    known = sent(mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 14800, 0, 55, 0, 0, 0, 0, 0, 0))
    unknown = sent(mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 65535, 0, -1, 0, 0, 0, 0, 0, 0))
    assert (told(heartbeat(), known).report(0).battery_v, told(heartbeat(), known).report(0).battery_fraction) == (
        14.8,
        0.55,
    )
    assert told(heartbeat(), unknown).report(0).battery_v is None


def test_a_restart_forgets_the_pose():
    before = [heartbeat(), estimator(), attitude(50_000), position(50_000, north=9.0)]
    after = [attitude(100 + k) for k in range(3)]
    telemetry = told(*before, *after)
    report = telemetry.report(101.0)
    assert (report.reboots, report.pose, report.has_position) == (1, None, False)
    telemetry.take(estimator(), 101.0)
    telemetry.take(position(400, north=5.0), 101.1)
    assert telemetry.report(101.2).pose == pytest.approx((0.0, 5.0, math.pi / 2))


def test_a_hand_on_the_joystick():
    channels = [1500, 1500, 1500, 1560, 1500, 1500]
    moved = sent(mavlink.MAVLink_rc_channels_message(1000, 8, *channels, *[1500] * 2, *[0] * 10, 0))
    telemetry = told(heartbeat(), moved)
    assert telemetry.stick_moved()
    assert not told(heartbeat()).stick_moved()


def test_joystick_axes_of_another_station_are_noticed_where_they_pass():
    telemetry = told(heartbeat(), sent(mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0), 255, 190))
    assert telemetry.foreign_stick_s == pytest.approx(100.1)


def test_an_unfamiliar_version_is_told_once():
    version = sent(
        mavlink.MAVLink_autopilot_version_message(0, 0x040000FF, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)
    )
    report = told(heartbeat(), version, version).report(0)
    assert report.autopilot == "ArduSub 4.0.0"
    assert [t.text for t in report.texts] == ["coral: ArduSub 4.0.0 is older than 4.1: GUIDED may not take velocities"]
