import socket

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea import udp_sonar
from coral.reef.sea.sonar_packets import encode_packet
from coral.reef.sea.udp_sonar import UdpSonar
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Stamped

rip = pytest.importorskip("wlsonar.range_image_protocol")
IMAGE = RangeImage(np.full((4, 8), 2.5, np.float32), 90.0, 40.0)


class FakeClock:
    now = 500.0

    def __call__(self):
        return self.now


class Sender:
    def __init__(self):
        self.clock = FakeClock()
        self.sonar = UdpSonar(0, clock=self.clock)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, data, host="127.0.0.1"):
        self.socket.sendto(data, (host, self.sonar.port))
        return self.sonar.read()

    def ping(self, device_s=0.0):
        return self.send(encode_packet(Stamped(device_s, IMAGE)))


@pytest.fixture
def sender():
    sender = Sender()
    yield sender
    sender.socket.close()
    sender.sonar.close()


def test_an_image_arrives_and_its_sender_is_known(sender):
    heard = sender.ping()
    assert np.array_equal(heard.value.ranges, IMAGE.ranges)
    assert heard.t == 500.0
    assert sender.sonar.name == f"Sonar 3D-15 at UDP port {sender.sonar.port}, from 127.0.0.1"


def test_a_packet_that_comes_late_has_an_old_stamp(sender):
    sender.ping(1_700_000_000.0)
    sender.clock.now = 500.7
    assert sender.ping(1_700_000_000.2).t == pytest.approx(500.2)


def test_nothing_and_other_messages_are_no_image(sender, monkeypatch):
    sender.sonar._socket.settimeout(0.001)
    assert sender.sonar.read() is None
    sender.sonar._socket.settimeout(0.2)
    assert sender.send(rip.packb(rip.ImuBatch(samples=1))) is None


def test_a_second_sonar_is_not_mixed_with_the_first(sender):
    sender.sonar.sender = "192.168.2.96"
    with pytest.raises(UnfitMeasurement) as error:
        sender.ping()
    assert error.value.reason == "another sender"


def test_garbage_is_refused_and_the_next_image_arrives(sender):
    with pytest.raises(UnfitMeasurement):
        sender.send(b"garbage")
    with pytest.raises(UnfitMeasurement):
        sender.send(b"")
    assert sender.ping() is not None


def test_packets_of_the_multicast_group_arrive():
    sonar = UdpSonar(0, "127.0.0.1")
    if not sonar.multicast:
        pytest.skip("no multicast on this machine")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        sender.sendto(encode_packet(Stamped(0.0, IMAGE)), (udp_sonar.GROUP, sonar.port))
        heard = sonar.read()
    sonar.close()
    assert heard is not None


def test_without_multicast_packets_to_this_computer_still_arrive():
    sonar = UdpSonar(0, "203.0.113.9")  # no address of this machine
    assert not sonar.multicast
    sonar.close()


def test_a_port_that_cannot_be_opened_is_one_line():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("", 0))
        with pytest.raises(InputError, match="a port that is free"):
            UdpSonar(taken.getsockname()[1])
    with pytest.raises(InputError, match="a port that is free"):
        UdpSonar(99_999)
