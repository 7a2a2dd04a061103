"""The link, against the simulated autopilot and, where CORAL_ARDUSUB is set, against ArduSub: the real one is right."""

import math

import numpy as np
import pytest
from messages import mavlink
from sea_vehicles import SimulatedVehicle, set_parameter

from autopilot.autopilot import SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.line import AutopilotLine
from coral.reef.sea.link import LinkRefused
from coral.reef.sea.mavlink_link import MavlinkLink

AHEAD = (0.5, 0.0, 1.0)


@pytest.fixture
def simulated():
    vehicle = SimulatedVehicle()
    vehicle.run(2.0)
    return vehicle


def send(vehicle, message, component=190):
    """Send as another station on the same line."""
    other = mavlink.MAVLink(None, 255, component)
    vehicle.link._line.send(message.pack(other))


# On both autopilots.


def test_the_report_is_complete(vehicle):
    report = vehicle.run(1.0)
    assert report.has_position
    assert report.autopilot.startswith("ArduSub 4.7.0-dev")
    assert report.velocity == pytest.approx((0.0, 0.0, 0.0), abs=0.2)
    assert 10.0 < report.battery_v < 20.0
    assert 0.0 < report.battery_fraction <= 1.0
    assert report.depth_m == pytest.approx(0.0, abs=3.0)
    assert report.heartbeat_age_s < 2.0
    assert report.reboots == report.clock_jumps == 0
    assert not report.armed
    assert not report.leak
    assert not report.manual_override
    for stamp in (report.pose_stamp_s, report.velocity_stamp_s, report.attitude_stamp_s, report.depth_stamp_s):
        assert -1.0 < stamp - vehicle.now() <= 0.0


def test_guided_velocities_move_it_ahead_at_depth(vehicle):
    vehicle.link.arm()
    assert vehicle.link.report().mode == "GUIDED"
    before = vehicle.run(6.0, AHEAD).pose
    report = vehicle.run(4.0, AHEAD)
    ahead = math.cos(before.theta) * (report.pose.x - before.x) + math.sin(before.theta) * (report.pose.y - before.y)
    assert ahead == pytest.approx(4.0 * 0.43, abs=0.3)
    assert report.velocity[0] == pytest.approx(0.43, abs=0.06)
    assert report.velocity[1] == pytest.approx(0.0, abs=0.1)
    assert report.depth_m == pytest.approx(1.0, abs=0.15)


def test_a_positive_yaw_rate_turns_left(vehicle):
    vehicle.link.arm()
    before = vehicle.run(1.0, (0.0, 0.0, 1.0))
    report = vehicle.run(4.0, (0.0, 0.3, 1.0))
    assert report.velocity[2] == pytest.approx(0.3, abs=0.05)
    assert report.tether_turns - before.tether_turns == pytest.approx(1.1 / math.tau, abs=0.05)


def test_it_stops_by_itself_when_commands_stop(vehicle):
    vehicle.link.arm()
    vehicle.run(5.0, AHEAD)
    assert vehicle.run(2.0).velocity[0] > 0.3
    report = vehicle.run(4.0)
    assert report.velocity[0] == pytest.approx(0.0, abs=0.1)
    assert report.armed


def test_hold_stops_and_commands_do_nothing_until_arm(vehicle):
    vehicle.link.arm()
    vehicle.run(3.0, AHEAD)
    vehicle.link.hold()
    assert vehicle.link.report().mode == "POSHOLD"
    assert vehicle.run(4.0, AHEAD).velocity[0] == pytest.approx(0.0, abs=0.1)
    vehicle.link.arm()
    assert vehicle.run(4.0, AHEAD).velocity[0] > 0.3


def test_surface_comes_up(vehicle):
    vehicle.link.arm()
    deep = vehicle.run(6.0, (0.0, 0.0, 1.5)).depth_m
    assert deep > 0.7
    vehicle.link.surface()
    assert vehicle.run(6.0).depth_m < 0.4


def test_refused_arming_comes_with_the_autopilots_words(vehicle):
    vehicle.set_parameter("BATT_ARM_VOLT", 20.0)
    try:
        with pytest.raises(LinkRefused, match=r"^arming refused: .*Battery 1 below minimum arming voltage"):
            vehicle.link.arm()
        assert not vehicle.run(1.0).armed
    finally:
        vehicle.set_parameter("BATT_ARM_VOLT", 0.0)
    vehicle.run(2.0)
    vehicle.link.arm()
    assert vehicle.link.report().armed


def test_a_mode_chosen_elsewhere_takes_over_until_the_operators_word(vehicle):
    vehicle.link.arm()
    vehicle.run(3.0, AHEAD)
    send(vehicle, mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1, 16, 0, 0, 0, 0, 0))
    report = vehicle.run(2.5, AHEAD)
    assert report.manual_override
    assert report.mode == "POSHOLD"
    vehicle.link.arm()
    assert not vehicle.run(2.0, AHEAD).manual_override


def test_a_hand_on_another_joystick_takes_over_at_once(vehicle):
    vehicle.link.arm()
    vehicle.run(3.0, AHEAD)
    for _ in range(10):
        send(vehicle, mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 400, 0))
        report = vehicle.run(0.1, AHEAD)
    assert report.manual_override
    report = vehicle.run(2.0, AHEAD)
    assert report.mode == "POSHOLD"
    assert report.armed
    assert report.velocity[0] == pytest.approx(0.0, abs=0.15)


def test_a_leak_is_reported(vehicle):
    water = 0x20000000
    send(vehicle, mavlink.MAVLink_sys_status_message(water, water, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0))
    assert vehicle.run(1.0).leak


# What only the simulated one can be told to do.


def test_without_a_position_it_is_not_armed():
    vehicle = SimulatedVehicle()
    vehicle.autopilot.parameters.write("SIM_GPS1_ENABLE", 0.0)
    vehicle.run(3.0)
    with pytest.raises(LinkRefused, match="no position"):
        vehicle.link.arm()
    assert not vehicle.run(1.0).armed


@pytest.mark.parametrize("command", [(math.nan, 0.1, 1.0), (0.5, math.inf, 1.0)])
def test_numbers_that_are_not_finite_stop(simulated, command):
    simulated.link.arm()
    simulated.run(4.0, AHEAD)
    assert simulated.run(3.0, command).velocity == pytest.approx((0.0, 0.0, 0.0), abs=0.02)


@pytest.mark.parametrize("taken_by", ["pilot", "hold", "disarming"])
def test_no_set_point_is_sent_to_a_vehicle_that_is_not_ours(simulated, taken_by):
    simulated.link.arm()
    simulated.run(2.0, AHEAD)
    if taken_by == "pilot":
        simulated.autopilot.choose("MANUAL")
    elif taken_by == "hold":
        simulated.link.hold()
    else:
        simulated.autopilot._disarm()
    simulated.run(2.5, AHEAD)
    sent = []
    simulated.autopilot.receive = lambda data, peer: sent.append(data)
    simulated.run(1.0, AHEAD)
    reader = mavlink.MAVLink(None, 0, 0)
    names = {message.get_type() for message in reader.parse_buffer(b"".join(sent))}
    assert "HEARTBEAT" in names
    assert "SET_POSITION_TARGET_LOCAL_NED" not in names


def test_a_depth_that_is_not_finite_holds_the_depth(simulated):
    simulated.link.arm()
    before = simulated.run(6.0, AHEAD).depth_m
    assert simulated.run(3.0, (0.5, 0.0, math.nan)).depth_m == pytest.approx(before, abs=0.1)


def test_a_silent_autopilot_refuses_by_its_silence():
    vehicle = SimulatedVehicle()
    vehicle.line.cut = True
    vehicle.run(1.0)
    with pytest.raises(LinkRefused, match="no autopilot has been heard"):
        vehicle.link.arm()


def test_an_order_into_a_broken_link_says_so(simulated):
    simulated.line.cut = True
    with pytest.raises(LinkRefused, match="the autopilot did not answer"):
        simulated.link.hold()


def test_something_else_than_a_submarine_is_not_armed(simulated):
    simulated.link._stations.vehicle.kind = 2
    with pytest.raises(LinkRefused, match="type 2, not a submarine"):
        simulated.link.arm()
    assert not simulated.autopilot.armed


def test_a_restart_ends_driving_and_the_streams_come_back(simulated):
    simulated.link.arm()
    simulated.run(3.0, AHEAD)
    simulated.autopilot.reboot()
    report = simulated.run(12.0, AHEAD)
    assert report.reboots == 1
    assert not report.armed
    assert report.has_position
    assert simulated.now() - report.pose_stamp_s < 0.2
    assert simulated.autopilot.body.velocity[0] < 0.1
    simulated.link.arm()
    assert simulated.run(5.0, AHEAD).velocity[0] > 0.3


def test_a_jump_of_the_clock_leaves_stamps_right(simulated):
    simulated.run(3.0)
    simulated.autopilot.jump_clock(100.0)
    report = simulated.run(3.0)
    assert (report.clock_jumps, report.reboots) == (1, 0)
    assert 0.0 <= simulated.now() - report.pose_stamp_s < 0.2


def test_a_cut_link_is_seen_by_its_ages_and_the_vehicle_helps_itself(simulated):
    simulated.link.arm()
    simulated.run(4.0, AHEAD)
    simulated.line.cut = True
    report = simulated.run(1.0, AHEAD)
    assert report.heartbeat_age_s > 0.9
    assert simulated.now() - report.pose_stamp_s > 0.9
    simulated.run(3.7, AHEAD)
    assert simulated.autopilot.body.velocity[0] < 0.1
    simulated.run(2.0, AHEAD)
    assert not simulated.autopilot.armed
    simulated.line.cut = False
    report = simulated.run(2.0, AHEAD)
    assert not report.armed
    assert simulated.run(3.0, AHEAD).velocity[0] == pytest.approx(0.0, abs=0.05)


def test_a_closed_link_leaves_the_vehicle_to_its_failsafes(simulated):
    simulated.link.arm()
    simulated.run(4.0, AHEAD)
    simulated.link.close()
    simulated.autopilot.step(4.7)
    assert simulated.autopilot.body.velocity[0] < 0.1
    simulated.autopilot.step(2.0)
    assert not simulated.autopilot.armed


def test_a_third_of_the_packets_lost_still_drives(simulated):
    simulated.line.loss = 0.33
    simulated.link.arm()
    report = simulated.run(12.0, AHEAD)
    assert report.velocity[0] == pytest.approx(0.43, abs=0.03)
    assert not report.manual_override


def test_late_packets_have_old_stamps(simulated):
    simulated.run(3.0)
    simulated.line.delay_s = 0.4
    report = simulated.run(2.0)
    assert simulated.now() - report.pose_stamp_s == pytest.approx(0.4, abs=0.15)


def test_the_failsafe_of_the_pilots_input_rests_while_we_drive():
    vehicle = SimulatedVehicle()
    vehicle.autopilot.parameters.write("FS_PILOT_INPUT", 2.0)
    vehicle.run(2.0)
    vehicle.link.arm()
    assert vehicle.run(8.0, AHEAD).armed


def test_it_rests_while_we_hold_too():
    """A vehicle that was told to hold must not be disarmed, and float up, for want of a joystick."""
    vehicle = SimulatedVehicle()
    vehicle.autopilot.parameters.write("FS_PILOT_INPUT", 2.0)
    vehicle.run(2.0)
    vehicle.link.arm()
    vehicle.link.hold()
    report = vehicle.run(8.0)
    assert report.armed
    assert report.mode == "POSHOLD"


def test_a_joystick_that_moves_while_we_hold_is_noticed(simulated):
    simulated.link.arm()
    simulated.run(2.0, AHEAD)
    simulated.link.hold()
    simulated.run(2.0)
    for _ in range(10):
        send(simulated, mavlink.MAVLink_manual_control_message(1, 400, 0, 500, 0, 0))
        report = simulated.run(0.1)
    assert report.manual_override


def test_the_end_of_surface_is_nobodys_override(simulated):
    simulated.link.arm()
    simulated.run(4.0, (0.0, 0.0, 1.0))
    simulated.link.surface()
    report = simulated.run(12.0)
    assert report.mode == "ALT_HOLD"
    assert not report.manual_override


def test_another_vehicle_on_the_line_is_not_listened_to(simulated):
    simulated.link.arm()
    simulated.run(2.0, AHEAD)
    stranger = mavlink.MAVLink(None, 2, 1)
    strange = mavlink.MAVLink_heartbeat_message(12, 3, 81, 19, 3, 3).pack(stranger)
    strange += mavlink.MAVLink_local_position_ned_message(1, 900, 900, 0, 0, 0, 0).pack(stranger)
    receive = simulated.line.receive
    simulated.line.receive = lambda timeout: bytes(strange) + receive(timeout)
    report = simulated.run(2.0, AHEAD)
    assert report.mode == "GUIDED"
    assert abs(report.pose.x) < 10
    assert report.reboots == 0
    assert "systems 1 and 2 are on the line" in report.identity_faults[0]
    assert any("systems 1 and 2" in text.text for text in report.texts)


def as_second_sender(simulated, data):
    """Let a second station send once, from another address."""
    simulated.line.sender = "another address"
    simulated.line.receive = lambda timeout: bytes(data)
    simulated.link.poll()
    del simulated.line.sender, simulated.line.receive


def test_a_second_vehicle_of_the_same_identity_keeps_both_from_arming(simulated):
    twin = mavlink.MAVLink(None, 1, 1)
    as_second_sender(simulated, mavlink.MAVLink_heartbeat_message(12, 3, 81, 19, 3, 3).pack(twin))
    assert "a second sender calls itself system 1" in simulated.link.report().identity_faults[0]
    with pytest.raises(LinkRefused, match="a second sender calls itself system 1"):
        simulated.link.arm()
    assert not simulated.run(0.5).armed


def test_a_twin_that_comes_later_is_told_and_neither_heard_nor_commanded(simulated):
    answered = []
    simulated.line.answer = answered.append
    simulated.link.arm()
    simulated.run(1.0, AHEAD)
    twin = mavlink.MAVLink(None, 1, 1)
    data = mavlink.MAVLink_heartbeat_message(12, 3, 81, 19, 3, 3).pack(twin)
    data += mavlink.MAVLink_local_position_ned_message(1, 900, 900, 0, 0, 0, 0).pack(twin)
    as_second_sender(simulated, data)
    report = simulated.run(1.0, AHEAD)
    assert (report.mode, report.reboots, answered) == ("GUIDED", 0, [])
    assert abs(report.pose.x) < 10
    assert any("a second sender" in text.text for text in report.texts)


def test_a_vehicle_that_moves_to_another_address_is_followed_but_has_to_be_armed_again(simulated):
    answered = []
    simulated.link.arm()
    simulated.line.answer = answered.append
    simulated.line.sender = "another port"
    report = simulated.run(12.0, AHEAD)
    assert answered == ["another port"]
    assert any("speaks from another port now" in text.text for text in report.texts)
    assert report.velocity[0] == pytest.approx(0.0, abs=0.1)
    simulated.link.arm()
    assert simulated.run(4.0, AHEAD).velocity[0] > 0.3


def test_half_a_message_of_a_stranger_does_not_garble_the_vehicle_s(simulated):
    for _ in range(20):
        as_second_sender(simulated, b"\xfd\x1c" + bytes(8))
        simulated.run(0.1)
    assert simulated.run(1.0).heartbeat_age_s < 1.5


def test_a_failsafe_that_surfaces_is_not_fought(simulated):
    set_parameter(simulated.link, "FS_LEAK_ENABLE", 2.0)
    simulated.link.arm()
    simulated.run(6.0, (0.3, 0.0, 2.0))
    simulated.autopilot.leak()
    report = simulated.run(4.0, (0.3, 0.0, 2.0))
    assert report.leak
    assert report.manual_override
    assert report.depth_m < 0.7


def test_the_thread_reads_and_close_ends_it():
    line = AutopilotLine(SimulatedAutopilot(Body(OpenWater())), np.random.default_rng(0))
    link = MavlinkLink(line, clock=line.clock)
    with link._heard:
        assert link._heard.wait_for(lambda: link.telemetry.said.mode == "MANUAL", 60.0)
    link.close()
    assert not link._thread.is_alive()
