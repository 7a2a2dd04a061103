"""Lines over loopback: what is sent arrives, what breaks is silence."""

import socket

import pytest

from coral.errors import InputError
from coral.reef.sea.transport import PEERS, RETRY_S, TcpLine, UdpLine, VehicleAddress, open_transport, parse_address


def bound():
    line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    line.bind(("127.0.0.1", 0))
    line.settimeout(5.0)
    return line


def test_udp_sends_and_receives():
    with bound() as vehicle:
        line = open_transport(VehicleAddress("udp", "127.0.0.1", vehicle.getsockname()[1]))
        line.send(b"hello")
        data, sender = vehicle.recvfrom(99)
        vehicle.sendto(b"there", sender)
        assert (data, line.receive(5.0)) == (b"hello", b"there")
        line.close()
        assert line.receive(0.0) == b""
        line.send(b"into nothing")


def test_udp_takes_nothing_from_a_stranger():
    with bound() as vehicle, bound() as stranger:
        line = open_transport(VehicleAddress("udp", "127.0.0.1", vehicle.getsockname()[1]))
        line.send(b"hello")
        _, ours = vehicle.recvfrom(99)
        stranger.sendto(b"forged", ours)
        assert line.receive(5.0) == b""
        vehicle.sendto(b"true", ours)
        assert line.receive(5.0) == b"true"
        line.close()


def test_udpin_answers_whoever_sends_and_remembers_few():
    line = UdpLine(VehicleAddress("udpin", "127.0.0.1", 0 or bound_free()))
    line.send(b"to nobody")
    vehicles = [bound() for _ in range(PEERS + 2)]
    for vehicle in vehicles:
        vehicle.sendto(b"x", ("127.0.0.1", line._socket.getsockname()[1]))
        assert line.receive(5.0) == b"x"
    assert len(line.peers) == PEERS
    assert line.sender == vehicles[-1].getsockname()
    line.send(b"all")
    assert [vehicle.recv(9) for vehicle in vehicles[-2:]] == [b"all", b"all"]
    line.answer(vehicles[-2].getsockname())
    line.send(b"you")
    assert vehicles[-2].recv(9) == b"you"
    vehicles[-1].setblocking(False)
    with pytest.raises(BlockingIOError):
        vehicles[-1].recv(9)
    for vehicle in vehicles:
        vehicle.close()
    line.close()


def bound_free():
    with bound() as line:
        return line.getsockname()[1]


def test_a_port_that_is_taken_is_one_line():
    with bound() as taken, pytest.raises(InputError, match="a port that is free"):
        open_transport(VehicleAddress("udpin", "127.0.0.1", taken.getsockname()[1]))


def test_tcp_is_opened_again_after_the_vehicle_restarts():
    now = [0.0]
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        line = TcpLine(VehicleAddress("tcp", *server.getsockname()), clock=lambda: now[0])
        line.receive(0.0)
        first, _ = server.accept()
        first.sendall(b"one")
        assert line.receive(5.0) == b"one"
        first.close()
        assert line.receive(5.0) == b""
        line.send(b"into nothing")
        assert line.receive(0.0) == b""
        now[0] += RETRY_S
        line.receive(0.0)
        second, _ = server.accept()
        second.sendall(b"two")
        assert line.receive(5.0) == b"two"
        line.send(b"three")
        assert second.recv(9) == b"three"
        second.close()
        line.close()


def test_a_line_that_cannot_be_opened_is_silent():
    line = open_transport(VehicleAddress("tcp", "127.0.0.1", bound_free()))
    assert line.receive(0.0) == b""
    line.send(b"x")
    line.close()


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("mavlink:udp:192.168.2.2:14550", VehicleAddress("udp", "192.168.2.2", 14550)),
        ("mavlink:udpin:0.0.0.0:14550", VehicleAddress("udpin", "0.0.0.0", 14550)),
        ("mavlink:tcp:localhost:5760", VehicleAddress("tcp", "localhost", 5760)),
        ("mavlink:tcp:[::1]:5760", VehicleAddress("tcp", "::1", 5760)),
        ("mavlink:udpin:0.0.0.0:14550#2", VehicleAddress("udpin", "0.0.0.0", 14550, system=2)),
    ],
)
def test_the_forms(text, address):
    assert parse_address(text) == address


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "mavlink:udp:HOST:PORT"),
        ("udp:1.2.3.4:14550", "mavlink:udp:HOST:PORT"),
        ("mavlink:upd:1.2.3.4:14550", "did you mean 'udp'?"),
        ("mavlink:udp:14550", "mavlink:udp:HOST:PORT"),
        ("mavlink:udp:host:", "mavlink:udp:HOST:PORT"),
        ("mavlink:udp:host:¹²", "mavlink:udp:HOST:PORT"),
        ("mavlink:udp:host:0", "port: found 0, expected a number from 1 to 65535"),
        ("mavlink:udp:host:65536", "port: found 65536"),
        ("mavlink:udp:host:" + "9" * 5000, "port: found 999"),
        ("mavlink:serial:/dev/x:9600", "mavlink:udp:HOST:PORT"),
        ("mavlink:udp:host:1#256", "system id: found '256'"),
        ("mavlink:udp:host:1#", "system id: found ''"),
    ],
)
def test_everything_else_is_one_line(text, says):
    with pytest.raises(InputError) as error:
        parse_address(text)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
