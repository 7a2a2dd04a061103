"""The simulated autopilot by its messages: modes, arming, set-points, streams, faults. Time is given."""

import math

import pytest
from messages import mavlink

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.parameters import ParameterStore


class Station:
    """A ground station that speaks to an autopilot and keeps what it says."""

    def __init__(self, autopilot=None, **cfg):
        self.autopilot = autopilot or SimulatedAutopilot(Body(OpenWater()), AutopilotCfg(position_after_s=1.0, **cfg))
        self.codec = mavlink.MAVLink(None, 255, 190)
        self.reader = mavlink.MAVLink(None, 0, 0)
        self.heard = []

    def say(self, message):
        self.autopilot.receive(bytes(message.pack(self.codec)))
        return self

    def order(self, command, *parameters):
        values = [*parameters, *[0.0] * (7 - len(parameters))]
        self.say(mavlink.MAVLink_command_long_message(1, 1, command, 0, *values))
        return self.wait(0.05).of("COMMAND_ACK")[-1].result

    def wait(self, seconds, message=None, beat=True):
        for k in range(round(seconds / 0.05)):
            if beat and k % 10 == 0:
                self.say(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            if message is not None and k % 2 == 0:
                self.say(message)
            self.autopilot.step(0.05)
            self.heard += self.reader.parse_buffer(self.autopilot.send()) or []
        return self

    def of(self, kind):
        return [m for m in self.heard if m.get_type() == kind]

    def texts(self):
        return [m.text for m in self.of("STATUSTEXT")]

    def guided(self):
        """Wait for a position, enter GUIDED and arm."""
        self.wait(2.0)
        assert self.order(mavlink.MAV_CMD_DO_SET_MODE, 1, 4) == 0
        assert self.order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == 0
        return self


def velocity(forward, yaw_rate=0.0, down=0.0, mask=0b0101_1100_0111, frame=9):
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, frame, mask, 0, 0, 0, forward, 0, down, 0, 0, 0, 0, yaw_rate
    )


def test_guided_needs_a_position():
    station = Station()
    assert station.order(mavlink.MAV_CMD_DO_SET_MODE, 1, 4) == 4
    assert station.texts() == ["Mode change failed: Guided requires position"]
    assert station.wait(1.0).order(mavlink.MAV_CMD_DO_SET_MODE, 1, 4) == 0
    assert station.wait(0.1).of("HEARTBEAT")[-1].custom_mode == 4


def test_arming_is_refused_with_a_reason():
    station = Station()
    station.autopilot.parameters.write("BATT_ARM_VOLT", 20.0)
    assert station.wait(1.0).order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == 4
    assert station.texts() == ["Arm: Battery 1 below minimum arming voltage"]
    kinds = [message.get_type() for message in station.heard]
    assert kinds.index("COMMAND_ACK") < kinds.index("STATUSTEXT")
    assert not station.autopilot.armed


def test_guided_follows_velocities_for_three_seconds_after_the_last():
    station = Station().guided().wait(5.0, velocity(0.5, yaw_rate=0.0, down=0.1))
    body = station.autopilot.body
    assert body.velocity[0] == pytest.approx(0.85 * 0.5, abs=0.01)
    assert body.depth_m > 0.3
    assert station.wait(2.8).autopilot.body.velocity[0] == pytest.approx(0.85 * 0.5, abs=0.01)
    assert station.wait(4.0).autopilot.body.velocity[0] == pytest.approx(0.0, abs=0.02)


def test_it_brakes_as_slowly_as_ardusub():
    """From 0.34 to 0.1 m/s in about a second."""
    station = Station().guided().wait(6.0, velocity(0.4))
    assert station.wait(0.5, velocity(0.0)).autopilot.body.velocity[0] > 0.15
    assert station.wait(1.0, velocity(0.0)).autopilot.body.velocity[0] < 0.1


def test_a_positive_yaw_rate_turns_right():
    station = Station().guided().wait(2.0, velocity(0.0, yaw_rate=0.3))
    assert station.autopilot.body.velocity[2] == pytest.approx(-0.3, abs=0.01)


@pytest.mark.parametrize(
    ("mask", "frame"), [(0b0101_1100_0000, 9), (0b0100_0000_0111, 9), (0b0101_1111_1111, 9), (0b0101_1100_0111, 0)]
)
def test_set_points_that_ardusub_drops_are_dropped(mask, frame):
    """Positions wanted too, accelerations not ignored, no velocities, a frame of positions."""
    station = Station().guided().wait(2.0, velocity(0.5, mask=mask, frame=frame))
    assert station.autopilot.body.velocity[0] == pytest.approx(0.0, abs=1e-6)


def test_the_joystick_drives_in_depth_hold():
    station = Station().wait(2.0)
    station.order(mavlink.MAV_CMD_DO_SET_MODE, 1, 2)
    station.order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    station.wait(8.0, mavlink.MAVLink_manual_control_message(1, 500, 0, 300, 200, 0))
    body = station.autopilot.body
    assert body.velocity[0] == pytest.approx(0.34, abs=0.03)
    assert body.velocity[2] == pytest.approx(-0.15, abs=0.01)
    assert body.down_m_s == pytest.approx(0.13, abs=0.01)
    station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 65, 100_000)
    seen = station.wait(0.5, mavlink.MAVLink_manual_control_message(1, 500, 0, 300, 200, 0)).of("RC_CHANNELS")[-1]
    assert (seen.chan3_raw, seen.chan4_raw, seen.chan5_raw) == (1420, 1540, 1600)
    assert station.wait(4.0).of("RC_CHANNELS")[-1].chan5_raw == 1500


def test_only_the_ground_stations_joystick_counts():
    station = Station()
    station.codec.srcSystem = 7
    station.wait(1.0, mavlink.MAVLink_manual_control_message(1, 500, 0, 500, 0, 0))
    assert station.autopilot.seen.pilot_heard_s == -math.inf


def test_surface_comes_up_and_ends_in_depth_hold():
    station = Station().guided().wait(6.0, velocity(0.0, down=0.3))
    station.order(mavlink.MAV_CMD_DO_SET_MODE, 1, 9)
    station.wait(10.0)
    assert station.autopilot.body.depth_m < 0.2
    assert station.autopilot.mode == "ALT_HOLD"
    assert station.autopilot.armed


def test_a_killed_program_stops_the_vehicle_after_three_seconds_and_disarms_after_five():
    station = Station().guided().wait(5.0, velocity(0.5))
    station.wait(4.4, beat=False)
    assert station.autopilot.body.velocity[0] < 0.1
    assert station.autopilot.armed
    assert not station.wait(1.0, beat=False).autopilot.armed
    assert station.texts()[-2:] == ["MYGCS: heartbeat lost", "Disarming motors"]


def test_the_position_is_given_up_after_dead_reckoning():
    station = Station().guided()
    station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 193, 100_000)
    station.autopilot.parameters.write("SIM_GPS1_ENABLE", 0.0)
    assert station.wait(7.0).of("EKF_STATUS_REPORT")[-1].flags == 831
    assert station.wait(1.0).of("EKF_STATUS_REPORT")[-1].flags == 37
    assert station.autopilot.mode == "GUIDED"
    assert station.autopilot.armed


def test_a_restart_is_silent_disarmed_and_counts_from_zero():
    station = Station().wait(5.0)
    station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 50_000)
    before = station.wait(1.0).of("ATTITUDE")[-1].time_boot_ms
    assert station.order(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == 0
    station.heard.clear()
    assert station.wait(1.5).heard == []
    station.wait(1.0).order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 50_000)
    assert station.wait(0.5).of("ATTITUDE")[-1].time_boot_ms < before


def test_a_restart_under_way_only_where_it_is_forced():
    station = Station().guided()
    assert station.order(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1, 0, 0, 0, 0, 20190226) == 0
    assert not station.wait(3.0).autopilot.armed


def test_a_leak_reported_by_a_sensor_elsewhere_surfaces():
    station = Station(
        SimulatedAutopilot(
            Body(OpenWater(), 3.0), AutopilotCfg(position_after_s=1.0), ParameterStore({"FS_LEAK_ENABLE": 2.0})
        )
    )
    station.guided()
    water = 0x20000000
    station.say(mavlink.MAVLink_sys_status_message(water, water, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)).wait(0.2)
    assert station.autopilot.mode == "SURFACE"
    assert "Leak Detected" in station.texts()


def test_messages_come_as_often_as_asked():
    station = Station().wait(2.0)
    assert station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 32, 100_000) == 0
    station.heard.clear()
    assert len(station.wait(5.0).of("LOCAL_POSITION_NED")) == 50
    assert station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 9999, 100_000) == 2
    station.order(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 32, -1)
    station.heard.clear()
    assert station.wait(2.0).of("LOCAL_POSITION_NED") == []


def test_time_in_pieces_is_time_at_once():
    """Determinism: the same inputs at the same times give the same bytes, however the time is cut."""

    def bytes_of(pieces):
        station = Station().guided()
        station.say(velocity(0.4, 0.2))
        for piece in pieces:
            station.autopilot.step(piece)
        return station.autopilot.send()

    assert bytes_of([1.0]) == bytes_of([0.02] * 50) != b""


def test_the_truth_is_told_for_cameras():
    station = Station().wait(2.0)
    station.autopilot.body.mover.vehicle.reset(type(station.autopilot.body.pose)(10.0, 20.0, 0.0))
    assert station.order(mavlink.MAV_CMD_REQUEST_MESSAGE, 108) == 0
    truth = station.of("SIM_STATE")[-1]
    assert (truth.lat_int - 430_000_000) * 1e-7 * math.pi / 180 * 6_378_137 == pytest.approx(20.0, abs=0.02)
    assert truth.yaw == pytest.approx(math.pi / 2)
