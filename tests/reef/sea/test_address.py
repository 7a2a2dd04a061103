"""Addresses: three forms, and one line for everything else."""

import pytest

from coral.errors import InputError
from coral.reef.sea.address import VehicleAddress, parse_address


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
