import json
import math
import socket
import threading
import time
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from served_a50 import ServedA50

from coral.errors import InputError
from coral.reef.rehearsal.truth import TruthFeed
from coral.reef.sea.address import parse_address
from coral.reef.sea.dvl_a50 import DvlA50, DvlState, merge, parse_line, watched
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.mavlink_link import MavlinkLink
from coral.reef.sea.safety import SafetyCfg, SafetyMonitor
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.world.geometry import Pose

VELOCITY = {
    "type": "velocity",
    "format": "json_v3",
    "vx": 0.3,
    "vy": 0.1,
    "vz": 0.0,
    "fom": 0.01,
    "covariance": [[0.0004, 0, 0], [0, 0.0001, 0], [0, 0, 0.0001]],
    "altitude": 1.2,
    "velocity_valid": True,
    "status": 0,
    "time_of_validity": 1_000_000,
    "time_of_transmission": 1_100_000,
}
POSITION = {"type": "position_local", "x": 2.0, "y": 1.0, "z": 0.5, "yaw": 90.0, "std": 0.05, "status": 0, "ts": 1.0}


def line(report, **changes):
    return json.dumps({**report, **changes}).encode()


def test_a_velocity_turns_from_right_to_left_and_is_as_old_as_it_says():
    state = parse_line(line(VELOCITY), 50.0, DvlState())
    assert state.velocity == (0.3, -0.1)
    assert state.velocity_stamp_s == pytest.approx(49.9)
    assert state.velocity_std_m_s == pytest.approx(0.02)
    assert (state.altitude_m, state.bottom_lock) == (1.2, True)


def test_a_position_turns_from_right_down_to_left_up():
    state = parse_line(line(POSITION), 50.0, DvlState())
    assert state.pose == pytest.approx(Pose(2.0, -1.0, -math.pi / 2))
    assert (state.pose_stamp_s, state.position_std_m) == (50.0, 0.05)


def test_without_bottom_lock_the_old_velocity_grows_old():
    state = parse_line(line(VELOCITY), 50.0, DvlState())
    after = parse_line(line(VELOCITY, velocity_valid=False, vx=9.0), 51.0, state)
    assert (after.velocity, after.velocity_stamp_s) == (state.velocity, state.velocity_stamp_s)
    assert not after.bottom_lock


@pytest.mark.parametrize(
    "bad",
    [
        b"",
        b"{",
        b"[1, 2]",
        b"null",
        line(VELOCITY, vx="fast"),
        line(VELOCITY, vx=float("nan")),
        line(VELOCITY, covariance=[[1]]),
        line(POSITION, yaw=None),
        line(POSITION, status=1),
        b'{"type": "velocity"}',
        b"[" * 5000,
    ],
)
def test_bad_lines_change_nothing(bad):
    before = parse_line(line(VELOCITY), 50.0, DvlState())
    assert parse_line(bad, 51.0, before) == before


@given(st.binary(max_size=200))
def test_any_bytes_are_survived(data):
    parse_line(data, 0.0, DvlState())


def test_the_dvl_replaces_pose_and_velocity_and_nothing_else():
    state = parse_line(line(POSITION), 50.0, parse_line(line(VELOCITY), 50.0, DvlState()))
    report = merge(VehicleReport(velocity=(9.0, 9.0, 0.2), depth_m=1.5, mode="GUIDED"), state)
    assert report.velocity == (0.3, -0.1, 0.2)
    assert report.pose == state.pose
    assert (report.depth_m, report.mode, report.has_position) == (1.5, "GUIDED", True)
    assert report.altitude_m == 1.2
    assert merge(VehicleReport(), replace(state, bottom_lock=False)).altitude_m is None


class FakeServer:
    """Sends lines to whoever connects; closes the first connection to see whether the client comes back."""

    def __init__(self):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.clients = 0
        self.sent_again = threading.Event()
        self.thread = threading.Thread(target=self.work, daemon=True)
        self.thread.start()

    def work(self):
        first, _ = self.socket.accept()
        text = line(VELOCITY) + b"\ngarbage\n" + line(POSITION)
        first.sendall(text[:40])
        first.sendall(text[40:] + b"\n")
        first.close()
        second, _ = self.socket.accept()
        second.sendall(line(POSITION, x=7.0) + b"\n")
        self.sent_again.set()
        self.second = second


def until(holds, event=threading.Event(), tries=500):  # noqa: B008
    for _ in range(tries):
        if holds():
            return True
        event.wait(0.01)
    return False


def test_a_connection_is_read_in_pieces_and_made_again():
    server = FakeServer()
    dvl = DvlA50("127.0.0.1", server.port)
    assert until(lambda: dvl.state.pose is not None)
    assert dvl.state.velocity == (0.3, -0.1)
    assert until(lambda: dvl.state.pose.x == 7.0)
    server.second.close()
    server.socket.close()
    dvl.close()


def test_nobody_there_is_one_line():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(InputError, match="--dvl: found"):
        DvlA50("127.0.0.1", port)


AUTOPILOTS = VehicleReport(pose=Pose(1.0, 2.0, 0.0), pose_stamp_s=100.0, has_position=True)


def test_while_the_dvl_measures_the_autopilots_position_is_taken():
    state = DvlState(velocity=(0.3, 0.0), velocity_stamp_s=99.8, bottom_lock=True)
    assert watched(AUTOPILOTS, state, 100.0) == replace(AUTOPILOTS, altitude_m=None)
    assert watched(AUTOPILOTS, replace(state, altitude_m=1.2), 100.0).altitude_m == 1.2


@pytest.mark.parametrize(
    ("state", "stamp_s"),
    [
        (DvlState(velocity=(0.3, 0.0), velocity_stamp_s=99.3, bottom_lock=True), 99.3),
        (DvlState(velocity=(0.3, 0.0), velocity_stamp_s=99.9, bottom_lock=False), 99.9),
        (DvlState(), -math.inf),
    ],
    ids=["silent", "no-bottom-lock", "never"],
)
def test_a_dvl_that_does_not_measure_takes_the_autopilots_position_away(state, stamp_s):
    report = watched(AUTOPILOTS, state, 100.0)
    assert not report.has_position
    assert report.pose_stamp_s == stamp_s


def test_a_served_a50_says_where_the_vehicle_is_and_how_fast():
    """A true circle to the left from a heading of 90 degrees, 0.4 m/s: the double and the reader agree with it."""
    clock = [0.0]

    def where():
        angle = 0.2 * clock[0]
        return clock[0], Pose(3.0 - 2.0 * (1.0 - math.cos(angle)), 1.0 + 2.0 * math.sin(angle), math.pi / 2 + angle)

    a50, state = ServedA50(where, clock=lambda: clock[0]), DvlState()
    a50.close()
    for tick in range(41):
        clock[0] = 0.1 * tick
        for report in a50.lines(tick):
            state = parse_line(json.dumps(report).encode(), clock[0], state)
    assert state.pose == pytest.approx(Pose(2.0 * math.sin(0.8), 2.0 * (1.0 - math.cos(0.8)), 0.8))
    assert state.velocity == pytest.approx((0.4, 0.0), abs=0.05)
    assert (state.bottom_lock, state.velocity_stamp_s) == (True, pytest.approx(3.95))
    assert state.altitude_m == pytest.approx(1.0, abs=0.05)
    a50.mode = "lost"
    assert not parse_line(json.dumps(a50.lines(1)[0]).encode(), 4.1, state).bottom_lock


@pytest.mark.ardusub
def test_a_silent_a50_is_noticed_within_a_second_while_ardusub_flies_on(ardusub_port, capsys):
    """Real time: the autopilot's own position is still good when the log's silence has long been seen."""
    link = MavlinkLink(parse_address(f"mavlink:tcp:127.0.0.1:{ardusub_port}"))
    feed = TruthFeed(parse_address(f"mavlink:tcp:127.0.0.1:{ardusub_port + 2}")).run()
    a50 = ServedA50(lambda: None if feed.state is None else (feed.state.stamp_s, feed.state.pose))
    dvl = DvlA50("127.0.0.1", a50.port)
    safety = SafetyMonitor(SafetyCfg(), SurveyArea("sea", (40.0, 40.0), Pose(20.0, 20.0, 0.0), ()), 600.0)
    idle = threading.Event()

    def fly(seconds, done=lambda: False):
        """Command 0.4 m/s ten times a second. Return the time until `done` held."""
        began = time.monotonic()
        while time.monotonic() - began < seconds and not done():
            link.command(0.4, 0.0, 1.0)
            idle.wait(0.1)
        return time.monotonic() - began

    def lost(view):
        breach = safety.check(time.monotonic(), 0.0, view(), None)
        return breach is not None and breach.cause == "pose"

    def by_dvl():
        return merge(link.report(), dvl.state)

    def by_watch():
        return watched(link.report(), dvl.state, time.monotonic())

    told = []
    try:
        assert until(lambda: link.report().has_position and feed.state is not None, tries=12_000)
        link.arm()
        first, begun = by_dvl(), feed.state.pose
        fly(5.0)
        assert not lost(by_dvl)
        assert not lost(by_watch)
        way = math.dist(by_dvl().pose[:2], first.pose[:2])
        assert way == pytest.approx(math.dist(feed.state.pose[:2], begun[:2]), abs=0.2)
        assert way > 0.5
        for mode in ("quiet", "lost"):
            for name, view in (("a50", by_dvl), ("watch", by_watch)):
                a50.mode = mode
                after_s = fly(5.0, lambda view=view: lost(view))
                told.append(f"--dvl {name}, {mode}: {after_s:.2f} s, autopilot says {link.report().has_position}")
                assert after_s < 1.0
                assert link.report().has_position
                a50.mode = "speaking"
                assert fly(5.0, lambda view=view: not lost(view)) < 3.0
    finally:
        with capsys.disabled():
            print("", *told, sep="\n")
        link.disarm()
        for each in (dvl, a50, feed, link):
            each.close()
