"""Records of a dataflash log, messages of a telemetry log."""

import math
import sys

import pytest
from autopilot_logs import START_S, dataflash, dataflash_dive, message, telemetry, telemetry_dive

from coral.errors import InputError
from coral.reef.recordings.log_samples import read_dataflash, read_telemetry

pytest.importorskip("pymavlink")


def kinds(content):
    found = {}
    for kind, t, values in read_dataflash(content):
        found.setdefault(kind, []).append((t, values))
    return found


def test_positions_of_the_estimator_in_charge_and_attitudes():
    found = kinds(
        dataflash(
            ("XKF1", 1.0, 0, 5.0, 7.0), ("XKF1", 1.0, 1, 9.0, 9.0), ("XKF4", 1.0, 0, 831, 1), ("XKF4", 1.0, 1, 167, 1),
            ("XKF1", 1.1, 0, 5.0, 7.0), ("XKF1", 1.1, 1, 9.0, 9.5), ("ATT", 1.2, 100, -200, 27000),
        )
    )  # fmt: skip
    assert found["position"] == [(1.0, (7.0, 5.0)), (pytest.approx(1.1), (9.5, 9.0))]
    assert found["standing"] == [(1.0, (1.0,))]
    assert found["attitude"][0][1] == pytest.approx(tuple(map(math.radians, (1.0, -2.0, 270.0))))


def test_places_ranges_and_the_time_of_the_satellites():
    found = kinds(
        dataflash(
            ("POS", 1.0, 0, 0), ("POS", 1.1, 483861421, -1246305728), ("GPS", 1.2, 1, 0, 0, 0, 0),
            ("GPS", 2.0, 3, 320_000, 2260, 483861421, -1246305728), ("RFND", 1.0, 150, 4, 25), ("RFND", 1.1, 150, 4, 0),
            ("RFND", 1.2, 150, 2, 25),
        )
    )  # fmt: skip
    assert found["place"] == [(pytest.approx(1.1), pytest.approx((-124.6305728, 48.3861421)))]
    # 2023-04-30 00:05:02 UTC: the week's beginning, 320 s, less 18 leap seconds.
    assert found["clock"][0][1][0] + 2.0 == 1_682_813_102.0
    assert found["range"] == [(1.0, (1.5,))]


def test_damaged_bytes_are_passed_over_and_counted():
    whole = dataflash(("XKF1", 1.0, 0, 5.0, 7.0), ("XKF1", 2.0, 0, 6.0, 7.0))
    found = kinds(whole[:-20] + b"\xa3\x95\x05rubbish" + whole[-20:] + whole[-20:-3])
    assert len(found["position"]) == 2
    assert sum(values[0] for _, values in found["unread"]) == 10 + 17


@pytest.mark.parametrize(
    ("old", "new"), [(b"QBff", b"QBf\0"), (b"PN,PE", b"PN,Up"), (b"QBff", b"QBnf"), (b"PN,PE", b"PN;PE")]
)
def test_a_format_that_contradicts_its_size_or_lacks_a_column_is_not_read(old, new):
    whole = dataflash_dive()
    assert "position" in kinds(whole)
    found = kinds(whole.replace(old, new))
    assert "position" not in found
    assert len(found["attitude"]) == 41


def said_by(content):
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
    found = said_by(content)
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
    found = said_by(bytes(content[:-5]))
    assert [kind for kind, _ in found].count("position") == 5
    assert found[-1][0] == "unread"
    assert found[-1][1][0] > 40


def test_two_vehicles_are_refused():
    position = message("local_position_ned")
    with pytest.raises(InputError, match="vehicles 1 and 2, expected a log of one"):
        said_by(telemetry((0.0, 1, 1, position), (1.0, 2, 1, position)))


def test_without_pymavlink_one_line_names_the_extra(monkeypatch):
    content = telemetry_dive(1)
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20.ardupilotmega", None)
    with pytest.raises(InputError, match=r"dive\.tlog: found no pymavlink, expected the extra vehicle"):
        said_by(content)
