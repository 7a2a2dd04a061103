"""The server over loopback. Waiting is for a message, never for a time."""

import socket

import pytest
from messages import mavlink

from autopilot.autopilot import SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.server import AutopilotServer
from coral.errors import InputError
from coral.reef.sea.transport import open_transport, parse_address


@pytest.fixture(params=["udp", "tcp"])
def server(request):
    server = AutopilotServer(SimulatedAutopilot(Body(OpenWater())), request.param)
    yield server
    server.close()


def heard(line, codec, kind):
    for _ in range(1000):
        line.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(codec))
        data = line.receive(0.1)
        for message in (codec.parse_buffer(data) or []) if data else []:
            if message.get_type() == kind:
                return message
    raise AssertionError(f"no {kind} came")


def test_two_stations_hear_one_vehicle(server):
    for component in (190, 191):
        line = open_transport(parse_address(server.address))
        assert heard(line, mavlink.MAVLink(None, 255, component), "HEARTBEAT").type == 12
        line.close()


def test_it_survives_a_station_that_leaves(server):
    line = open_transport(parse_address(server.address))
    heard(line, mavlink.MAVLink(None, 255, 190), "HEARTBEAT")
    line.close()
    other = open_transport(parse_address(server.address))
    assert heard(other, mavlink.MAVLink(None, 255, 190), "HEARTBEAT")
    other.close()


def test_a_taken_port_and_an_unknown_medium_are_one_line():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(InputError, match="a free port"):
            AutopilotServer(SimulatedAutopilot(Body(OpenWater())), port=taken.getsockname()[1])
    with pytest.raises(InputError, match="udp or tcp"):
        AutopilotServer(SimulatedAutopilot(Body(OpenWater())), "pigeon")
