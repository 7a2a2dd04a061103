"""Every fault of a survey through MAVLink ends in its configured state within a second, on the simulated autopilot."""

import errno
import re
import time
from pathlib import Path

import pytest
from mavlink_voyage import MavlinkVoyage

import coral
from reef.failing_sensors import fail

AT_S = 3.0
STEP = 30


@pytest.mark.parametrize(
    "failure",
    [
        "nan-pose",
        "blind-camera",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("stale-pose", "nan-velocity", "wrong-size", "stale-frame")
        ),
    ],
)
def test_a_sensor_that_fails_holds_the_vehicle_and_lets_it_go_on(tmp_path, failure):
    voyage = MavlinkVoyage(tmp_path / "run", time_limit_s=8.0)
    fail(voyage.mission.robot.vehicle, failure, AT_S, AT_S + 2.0)
    voyage.run()
    assert voyage.first("holding", AT_S) <= 1.0
    assert voyage.first("surveying", AT_S + 2.0) <= 2.0
    assert voyage.waters.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("begin", "state", "cause"),
    [
        (lambda v: setattr(v.line, "cut", True), "holding", "link"),
        (lambda v: v.autopilot.reboot(), "holding", "link"),
        (lambda v: v.autopilot.choose("MANUAL"), "taken over", None),
        (lambda v: v.autopilot._disarm(), "taken over", None),
        (lambda v: v.parameter("SIM_BATT_VOLTAGE", 10.5), "surfacing", "battery"),
        (lambda v: v.autopilot.jump_clock(5.0), "holding", "clock"),
    ],
    ids=["link-loss", "reboot", "pilot", "disarmed", "low-battery", "clock-jump"],
)
def test_a_fault_of_the_vehicle_ends_in_its_state(tmp_path, begin, state, cause):
    voyage = MavlinkVoyage(tmp_path / "run", battery_min_v=11.5, battery_min=0.0, on_battery="surface")
    voyage.at[STEP] = lambda: begin(voyage)
    voyage.run()
    assert voyage.first(state, AT_S) <= 1.0, [e for e in voyage.events if e["event"] in ("state", "limit")]
    told = [event["cause"] for event in voyage.events if event["event"] == "limit"]
    assert cause is None or told[0] == cause


def test_a_leak_surfaces(tmp_path):
    voyage = MavlinkVoyage(tmp_path / "run")
    voyage.at[STEP] = lambda: voyage.autopilot.leak(3.0)
    voyage.run()
    assert voyage.first("surfacing", AT_S) <= 1.0
    assert voyage.autopilot.mode in ("SURFACE", "ALT_HOLD")


def test_a_full_disk_stops_the_recording_and_not_the_vehicle(tmp_path):
    voyage = MavlinkVoyage(tmp_path / "run", time_limit_s=6.0)

    def fill():
        def no_room(*_, **__):
            raise OSError(errno.ENOSPC, "No space left on device")

        voyage.mission.record.writer.row = no_room

    voyage.at[STEP] = fill
    result = voyage.run()
    assert "No space left" in result["recording_failure"]
    assert any(event["event"] == "recording_stopped" for event in voyage.events)
    assert {state for t, state in voyage.states if t > AT_S} == {"surveying"}
    assert result["ticks"] >= 58


def test_a_program_that_dies_leaves_a_vehicle_that_stands(tmp_path):
    """Nothing is sent any more: GUIDED stops after 3 s by itself, then the failsafe of the ground station disarms."""
    voyage = MavlinkVoyage(tmp_path / "run", time_limit_s=AT_S)
    voyage.run()
    voyage.link.arm()
    for _ in range(20):
        voyage.link.command(0.4, 0.0, 1.0)
        voyage.sleep(0.1)
    assert voyage.autopilot.body.velocity[0] > 0.2
    voyage.autopilot.step(5.0)
    assert abs(voyage.autopilot.body.velocity[0]) < 0.05
    voyage.autopilot.step(5.0)
    assert not voyage.autopilot.armed


def test_a_system_clock_that_is_set_changes_nothing(tmp_path, monkeypatch):
    def survey(folder, jump):
        voyage = MavlinkVoyage(folder, time_limit_s=4.5)
        voyage.at[STEP] = lambda: jump(-86400.0)
        voyage.at[STEP + 7] = lambda: jump(3600.0)
        voyage.run()
        return voyage.states, (folder / "trajectory.csv").read_text()

    def jump(seconds, now=time.time):
        monkeypatch.setattr(time, "time", lambda: now() + seconds)
        monkeypatch.setattr(time, "time_ns", lambda: int((now() + seconds) * 1e9))

    calm = survey(tmp_path / "calm", lambda _: None)
    assert survey(tmp_path / "jumped", jump) == calm


def test_nothing_that_drives_reads_the_time_of_day():
    """Monotonic clocks alone: a clock set by NTP or by a person moves no stamp, no limit and no due time."""
    source = Path(coral.__file__).parent
    driving = [*source.glob("reef/*/*.py"), *source.glob("mppi/*.py")]
    driving = [path for path in driving if path.parent.name not in ("products", "recordings", "paint")]
    driving += [source / "commands" / name for name in ("reef_sail.py", "sail_parts.py")]
    wall = re.compile(r"\btime\.(time|time_ns|localtime|gmtime|ctime|strftime)\(|\bdate(time)?\.(now|utcnow|today)\(")
    assert len(driving) > 100
    assert [path.name for path in driving if re.search(wall, path.read_text())] == []
