import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.recorded_sonar import RecordedSonar
from coral.reef.sea.sonar_packets import SonarPing, encode_packet
from coral.reef.vehicle.range_image import RangeImage

rip = pytest.importorskip("wlsonar.range_image_protocol")


class FakeClock:
    now = 100.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


def packet(metres, device_s):
    return encode_packet(SonarPing(RangeImage(np.full((2, 3), metres, np.float32), 90.0, 40.0), device_s))


def played(tmp_path, *packets):
    path = tmp_path / "dive.sonar"
    path.write_bytes(b"".join(packets))
    clock = FakeClock()
    return RecordedSonar(path, clock, clock.sleep)


def test_images_come_as_fast_as_they_were_recorded(tmp_path):
    sonar = played(tmp_path, packet(1.0, 50.0), packet(2.0, 50.2), rip.packb(rip.ImuBatch()), packet(3.0, 50.4))
    found = [sonar.read() for _ in range(4)]
    assert [None if each is None else round(each.stamp_s, 6) for each in found] == [100.0, 100.2, None, 100.4]
    assert [each.image.ranges[0, 0] for each in found if each] == [1.0, 2.0, 3.0]
    with pytest.raises(OSError, match="ended"):
        sonar.read()
    sonar.close()


def test_a_jump_of_the_recorded_clock_is_not_waited_for(tmp_path):
    sonar = played(tmp_path, packet(1.0, 50.0), packet(2.0, 5000.0), packet(3.0, 10.0))
    assert [round(sonar.read().stamp_s, 6) for _ in range(3)] == [100.0, 101.0, 101.0]


def test_a_broken_packet_is_refused_and_the_next_one_read(tmp_path):
    broken = bytearray(packet(2.0, 50.2))
    broken[-1] ^= 1
    sonar = played(tmp_path, packet(1.0, 50.0), bytes(broken), packet(3.0, 50.4))
    sonar.read()
    with pytest.raises(UnfitMeasurement, match="wrong checksum"):
        sonar.read()
    assert sonar.read().image.ranges[0, 0] == 3.0


def test_what_is_no_recording_is_one_line(tmp_path):
    with pytest.raises(InputError, match="a recording of the sonar"):
        RecordedSonar(tmp_path / "nowhere.sonar")
    (tmp_path / "text.sonar").write_text("this is no recording")
    with pytest.raises(InputError, match="wrong identifier"):
        RecordedSonar(tmp_path / "text.sonar")
