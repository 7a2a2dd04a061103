"""Random bytes and damaged frames into the link and into the autopilot: nothing raises, and both go on working."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
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
bounded = settings(max_examples=60, suppress_health_check=list(HealthCheck))


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
