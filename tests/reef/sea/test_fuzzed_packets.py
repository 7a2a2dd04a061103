"""Random bytes and damaged frames into the link and into the autopilot: nothing raises, and both go on working."""

import csv
import dataclasses
import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mavlink_voyage import MavlinkVoyage
from messages import mavlink
from sea_vehicles import SimulatedVehicle

NUMBERS = sorted(set(mavlink.mavlink_map) & set(range(400)))
"""Message ids of the common set and ArduPilot's own."""


class Arbitrary(mavlink.MAVLink_message):
    """A message with any content and a valid checksum."""

    def __init__(self, number, content):
        kind = mavlink.mavlink_map[number]
        super().__init__(number, kind.msgname)
        self.content = content[: kind.unpacker.size].ljust(kind.unpacker.size, b"\0")
        self.kind = kind

    def framed(self, system, component):
        sender = mavlink.MAVLink(None, system, component)
        return bytes(self._pack(sender, self.kind.crc_extra, self.content))


def frame_of(number, content, system, component):
    return Arbitrary(number, content).framed(system, component)


frames = st.builds(
    frame_of,
    st.sampled_from(NUMBERS),
    st.binary(min_size=0, max_size=255),
    st.sampled_from([1, 1, 1, 2, 255]),
    st.sampled_from([1, 1, 1, 190, 197]),
)


@st.composite
def damaged(draw):
    data = bytearray(draw(frames))
    for _ in range(draw(st.integers(1, 4))):
        data[draw(st.integers(0, len(data) - 1))] = draw(st.integers(0, 255))
    return bytes(data[: draw(st.integers(1, len(data)))])


packets = st.lists(st.one_of(st.binary(max_size=300), frames, damaged()), min_size=1, max_size=12)
bounded = settings(max_examples=20, suppress_health_check=list(HealthCheck))


@bounded
@given(packets=packets)
def test_the_link_survives_what_comes(packets):
    vehicle = SimulatedVehicle()
    vehicle.run(1.5)
    receive, waiting = vehicle.line.receive, list(packets)
    vehicle.line.receive = lambda timeout: (waiting.pop(0) if waiting else b"") + receive(timeout)
    vehicle.run(1.0, (0.3, 0.1, 1.0))
    report = vehicle.run(6.0, (0.3, 0.1, 1.0))
    assert report.heartbeat_age_s < 2.0
    assert report.mode


@bounded
@given(packets=packets)
def test_the_autopilot_survives_what_comes(packets):
    vehicle = SimulatedVehicle()
    vehicle.run(1.5)
    for k, data in enumerate(packets):
        vehicle.autopilot.receive(data, k % 3)
        vehicle.autopilot.step(0.05)
    vehicle.run(4.0)
    pose = vehicle.autopilot.body.pose
    assert all(abs(value) < 100 for value in pose)
    assert vehicle.link.report().heartbeat_age_s < 2.0


READ = {
    *("HEARTBEAT", "ATTITUDE", "LOCAL_POSITION_NED", "EKF_STATUS_REPORT", "VFR_HUD", "SYS_STATUS", "STATUSTEXT"),
    *("AUTOPILOT_VERSION", "RC_CHANNELS", "TIMESYNC", "COMMAND_ACK", "PARAM_VALUE", "MANUAL_CONTROL"),
    "RC_CHANNELS_OVERRIDE",
}
"""What the link reads."""
KINDS = [kind for kind in mavlink.mavlink_map.values() if kind.msgname in READ]
REALS = st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -0.0, 1e-38, 3.4e38, -3.4e38, 1e6, -180.0])


def hostile_value(kind):
    """Draw a value of a field at the end of its range, or anywhere in it."""
    if kind == "char":
        return st.binary(max_size=50)
    if kind in ("float", "double"):
        return REALS
    bits = int("".join(filter(str.isdigit, kind.removesuffix("_t"))))
    low, high = (0, 2**bits - 1) if kind.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return st.one_of(st.sampled_from([low, low + 1, 0, high - 1, high]), st.integers(low, high))


@st.composite
def hostile(draw):
    kind = draw(st.sampled_from(KINDS))
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    values = []
    for name, form in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        many = lengths[name] if form != "char" else 0
        if name == "time_boot_ms" and draw(st.booleans()):  # a believable time, so that the rest is read
            values.append(draw(st.integers(1500, 4000)))
            continue
        values.append(
            draw(st.lists(hostile_value(form), min_size=many, max_size=many) if many else hostile_value(form))
        )
    sender = draw(st.sampled_from([(1, 1), (1, 1), (1, 1), (2, 1), (255, 190)]))
    return kind(*values).pack(mavlink.MAVLink(None, *sender))


def numbers_of(report):
    for value in dataclasses.asdict(report).values():
        for part in value if isinstance(value, list | tuple) else [value]:
            if isinstance(part, float):
                yield part


@bounded
@given(sent=st.lists(hostile(), min_size=1, max_size=12))
def test_the_link_reports_only_numbers_whatever_a_well_formed_message_says(sent):
    vehicle = SimulatedVehicle()
    vehicle.run(1.5)
    receive, waiting = vehicle.line.receive, list(sent)
    vehicle.line.receive = lambda timeout: (waiting.pop(0) if waiting else b"") + receive(timeout)
    for _ in range(30):
        report = vehicle.run(0.05, (0.3, 0.1, 1.0))
        assert not any(math.isnan(value) for value in numbers_of(report))
        assert all(math.isfinite(value) for value in [*(report.pose or ()), *(report.velocity or ())])
    assert vehicle.run(6.0, (0.3, 0.1, 1.0)).heartbeat_age_s < 2.0


EXTREMES = {"high": math.inf, "low": -math.inf, "nothing": math.nan}


def extreme(kind, end):
    """Return a message with every field at the end of its range."""

    def value(form):
        if form in ("float", "double"):
            return EXTREMES[end]
        if form == "char":
            return b"\xff" * 8
        bits = int("".join(filter(str.isdigit, form.removesuffix("_t"))))
        unsigned = form.startswith("u")
        return (
            0
            if end == "nothing"
            else (2 ** (bits - (not unsigned)) - 1)
            if end == "high"
            else -(not unsigned) << (bits - 1)
        )

    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    pairs = zip(kind.fieldnames, kind.fieldtypes, strict=True)
    values = [
        [value(form)] * lengths[name] if lengths[name] and form != "char" else value(form) for name, form in pairs
    ]
    return kind(*values).pack(mavlink.MAVLink(None, 1, 1))


@pytest.mark.parametrize("end", EXTREMES)
def test_a_survey_outlives_every_message_at_the_ends_of_its_range(tmp_path, end):
    """An autopilot that says so is obeyed: the vehicle may be held, surfaced or given up, but by a rule."""
    voyage = MavlinkVoyage(tmp_path / "run", time_limit_s=6.0)
    sent = [extreme(kind, end) for number, kind in sorted(mavlink.mavlink_map.items()) if number < 400]
    receive = voyage.line.receive

    def flooded(timeout):
        return (
            b"".join(sent.pop() for _ in range(3)) if voyage.mission.step > 20 and len(sent) > 2 else b""
        ) + receive(timeout)

    voyage.line.receive = flooded
    voyage.run()
    assert len(sent) < 3
    rows = list(csv.DictReader((tmp_path / "run" / "trajectory.csv").open()))
    assert len(rows) >= 55
    assert all(math.isfinite(float(row[name])) for row in rows for name in ("x", "y", "theta"))
    assert voyage.waters.collisions == 0
