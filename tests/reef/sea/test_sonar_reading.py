import numpy as np

from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.sonar_reading import HeardImage, LatestHeard
from coral.reef.vehicle.range_image import RangeImage

IMAGE = RangeImage(np.full((2, 3), 4.0, np.float32), 90.0, 40.0)


class Source:
    name = "test"

    def __init__(self, *found):
        self.found, self.closed = list(found), False

    def read(self):
        found = self.found.pop(0)
        if isinstance(found, Exception):
            raise found
        return found

    def close(self):
        self.closed = True


def heard(stamp_s):
    return HeardImage(stamp_s, IMAGE)


def reading(*found, **changes):
    sonar = LatestHeard(Source(*found), threaded=False, **changes)
    sonar._closing.set()  # no pause after a failure
    for _ in found:
        sonar.step()
    return sonar


def test_the_newest_image_is_kept():
    sonar = reading(heard(1.0), None, heard(2.0))
    assert (sonar.latest.stamp_s, sonar.failure) == (2.0, "")


def test_refused_packets_are_counted_by_name_and_change_nothing():
    spoiled = UnfitMeasurement("wrong checksum"), UnfitMeasurement("wrong checksum"), UnfitMeasurement("cut off", "3")
    sonar = reading(heard(1.0), *spoiled)
    assert sonar.refused == {"wrong checksum": 2, "cut off": 1}
    assert sonar.failure == "cut off (3)"
    assert sonar.latest.stamp_s == 1.0


def test_a_sonar_that_fails_says_why_and_comes_back():
    assert reading(heard(1.0), OSError("no cable")).failure == "no cable"
    assert reading(OSError("no cable"), heard(2.0)).failure == ""


def test_its_rate_is_measured():
    times = iter([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert reading(*map(heard, range(6)), clock=lambda: next(times)).rate_hz == 5.0
    assert reading(heard(1.0)).rate_hz is None


def test_it_reads_on_a_thread_and_closes_its_source():
    class Endless(Source):
        def read(self):
            return heard(1.0)

    source = Endless()
    sonar = LatestHeard(source)
    for _ in range(1000):
        if sonar.latest is not None:
            break
        sonar._closing.wait(0.005)
    sonar.close()
    assert sonar.latest is not None
    assert source.closed
