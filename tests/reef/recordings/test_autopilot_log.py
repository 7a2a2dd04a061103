"""The track of a log."""

import math

import pytest

pytest.importorskip("pymavlink")

from autopilot_logs import RECORDS, START_S, dataflash, dataflash_dive, message, telemetry, telemetry_dive

from coral.errors import InputError
from coral.reef.recordings.autopilot_log import read_log, tell_span


def log(tmp_path, content, name="dive.BIN"):
    (tmp_path / name).write_bytes(content)
    return tmp_path / name


@pytest.mark.parametrize(
    ("name", "made", "start"), [("dive.BIN", dataflash_dive, 100.0), ("dive.tlog", telemetry_dive, START_S)]
)
def test_north_east_down_becomes_east_north_up(tmp_path, name, made, start):
    track = read_log(log(tmp_path, made(), name))
    assert track.span == pytest.approx((start, start + 4.0))
    found = track.at(start + 1.03)
    assert found == pytest.approx(
        {"x": 3.0, "y": 0.515, "yaw": math.pi / 4, "roll": 0.0, "pitch": math.radians(10.0)}, abs=1e-5
    )
    assert track.at(start + 7.0) is None
    assert track.remark == ""


def test_a_range_finder_gives_the_height_of_a_tilted_vehicle(tmp_path):
    records = [("RFND", 100.0 + 0.1 * k, 200, 4, 25) for k in range(20)]
    content = dataflash_dive() + dataflash(*records, known=RECORDS)
    found = read_log(log(tmp_path, content)).at(100.55)
    assert found["z"] == pytest.approx(2.0 * math.cos(math.radians(10.0)), abs=1e-5)


def test_places_alone_give_degrees_and_a_satellite_the_time(tmp_path):
    fixes = [("POS", 2.0 + k, 480000000 + 100 * k, 90000000) for k in range(3)]
    fixes.append(("GPS", 2.0, 3, 320_000, 2260, 480000000, 90000000))
    turns = [("ATT", 2.0 + 0.5 * k, 0, 0, 9000) for k in range(6)]
    track = read_log(log(tmp_path, dataflash(*fixes, *turns)))
    assert track.span == pytest.approx((1_682_813_102.0, 1_682_813_104.0))
    assert track.at(track.span[0] + 0.5) == pytest.approx(
        {"lat": 48.000005, "lon": 9.0, "heading": 90.0, "roll": 0.0, "pitch": 0.0}
    )


def test_a_single_wrong_stamp_is_left_out_and_a_cut_end_told(tmp_path):
    content = bytearray(telemetry_dive())
    content[2] ^= 1
    track = read_log(log(tmp_path, bytes(content[:-7]), "dive.tlog"))
    assert track.span[0] == pytest.approx(START_S + 0.2)
    assert track.remark == "dive.tlog: 29 bytes of damaged or cut off messages left out"


STILL_EARTH = [("XKF4", 1.0, 0, 65703, 0), ("POS", 1.1, 480000000, 90000000), ("ATT", 1.1, 0, 0, 0)]
STILL = [("XKF4", 1.0, 0, 65703, 0), ("XKF1", 1.1, 0, 0.0, 0.0), ("ATT", 1.1, 0, 0, 0)]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "found an empty file, expected an ArduPilot dataflash log"),
        (b"text that is no log", "position: found no messages"),
        (dataflash(*STILL), "position: found an estimator that stood still for want of a DVL or a GPS"),
        (dataflash(*STILL_EARTH), "position: found an estimator that stood still for want of a DVL or a GPS"),
        (dataflash(("XKF1", 1.0, 0, 2e9, 2e9), ("ATT", 1.0, 0, 0, 0)), "position: found no messages"),
        (dataflash(("XKF1", 1.0, 0, 1.0, 1.0)), "attitude: found no messages"),
        (dataflash_dive() + dataflash_dive(), "time: found a time stamp of 100.100 s after one of 103.900 s"),
        (dataflash(("XKF1", 1.0, 0, math.nan, 1e30), ("ATT", 1.0, 0, 0, 0)), "position: found no messages"),
    ],
)
def test_what_gives_no_track_is_one_line(tmp_path, content, said):
    with pytest.raises(InputError) as caught:
        read_log(log(tmp_path, content))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_positions_while_the_estimator_had_none_are_left_out(tmp_path):
    found = []
    for k in range(10):
        position = message("local_position_ned", x=1.0 * k)
        flags = message("ekf_status_report", flags=167 if k < 5 else 831)
        found += [(0.2 * k, 1, 1, one) for one in (flags, position, message("attitude"))]
    track = read_log(log(tmp_path, telemetry(*found), "dive.tlog"))
    assert track.span == pytest.approx((START_S + 1.0, START_S + 1.8))


def test_spans_are_told_in_utc_or_seconds():
    assert tell_span(3.0, 4.5) == "3.0 to 4.5 s"
    assert tell_span(START_S, START_S + 1).startswith("2023-05-04 17:16:40 UTC (1683220600.0 s) to 2023-05-04 17:16:41")
