"""Messages of a telemetry log."""

import sys

import pytest

pytest.importorskip("pymavlink")

from autopilot_logs import START_S, message, telemetry, telemetry_dive

from coral.errors import InputError
from coral.reef.recordings.telemetry_log import read_telemetry


def kinds(content):
    return [(kind, values) for kind, _, values in read_telemetry(content, "dive.tlog")]


def test_only_the_autopilots_messages_count():
    position = message("local_position_ned", x=5.0, y=7.0)
    content = telemetry(
        (0.0, 255, 190, message("heartbeat", type=6, autopilot=8)), (1.0, 1, 197, position), (2.0, 1, 1, position)
    )
    (found, unread) = read_telemetry(content, "dive.tlog")
    assert found == ("position", START_S + 2.0, (7.0, 5.0))
    assert unread[2] == (0.0,)


def test_what_each_message_says():
    content = telemetry(
        (0.0, 1, 1, message("attitude", roll=0.25, pitch=-0.5, yaw=1.0)),
        (0.0, 1, 1, message("global_position_int", lat=483861421, lon=-1246305728)),
        (0.0, 1, 1, message("global_position_int")),
        (0.0, 1, 1, message("ekf_status_report", flags=167)),
        (0.0, 1, 1, message("rangefinder", distance=1.5)),
        (0.0, 1, 1, sounder(orientation=25, current_distance=200)),
        (0.0, 1, 1, sounder(orientation=0, current_distance=200)),
        (0.0, 1, 1, message("odometry", frame_id=1, x=5.0, y=7.0, q=[1, 0, 0, 0], **covariances())),
    )
    found = kinds(content)
    assert [kind for kind, _ in found] == ["attitude", "place", "standing", "range", "range", "position", "unread"]
    assert found[0][1] == (0.25, -0.5, 1.0)
    assert [found[k][1] for k in (2, 3, 4, 5)] == [(1.0,), (1.5,), (2.0,), (7.0, 5.0)]


def sounder(**values):
    return message("distance_sensor", min_distance=10, max_distance=900, quaternion=[0.0] * 4, **values)


def covariances():
    return {"pose_covariance": [0.0] * 21, "velocity_covariance": [0.0] * 21}


def test_a_wrong_checksum_and_a_cut_end_are_left_out():
    content = bytearray(telemetry_dive(1))
    content[8 + 12] ^= 1  # in the payload of the first message
    found = kinds(bytes(content[:-5]))
    assert [kind for kind, _ in found].count("position") == 5
    assert found[-1][0] == "unread"
    assert found[-1][1][0] > 40


def test_two_vehicles_are_refused():
    position = message("local_position_ned")
    with pytest.raises(InputError, match="vehicles 1 and 2, expected a log of one"):
        kinds(telemetry((0.0, 1, 1, position), (1.0, 2, 1, position)))


def test_without_pymavlink_one_line_names_the_extra(monkeypatch):
    content = telemetry_dive(1)
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20.ardupilotmega", None)
    with pytest.raises(InputError, match=r"dive\.tlog: found no pymavlink, expected the extra vehicle"):
        kinds(content)
