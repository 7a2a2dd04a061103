import threading
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.latest_reading import KEPT, LatestReading, LatestShot, Shot, rate_of, rate_told
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label

FRAME = Frame(np.zeros((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.full((2, 2), -1, np.int32))


class Source:
    """Measures the numbers of a list; an error in it is raised."""

    def __init__(self, found):
        self.found, self.closed = list(found), False

    def read(self):
        value = self.found.pop(0) if self.found else None
        if isinstance(value, Exception):
            raise value
        return value

    def close(self):
        self.closed = True


def reading_of(source, **options):
    return LatestReading(source, "numbers", **options)


def test_the_newest_is_kept_while_none_comes():
    reading = reading_of(Source([1.0, None, 2.0, None]), threaded=False)
    assert reading.latest is None
    seen = []
    for _ in range(4):
        reading.step()
        seen.append(reading.latest)
    assert seen == [1.0, 1.0, 2.0, 2.0]


def test_a_failure_is_told_until_the_sensor_is_back():
    reading = reading_of(Source([OSError("no signal\nmore"), None, 3.0]), threaded=False)
    reading._closing.set()  # no pause
    reading.step()
    assert reading.failure == "no signal"
    reading.step()
    assert reading.failure == "no signal"
    reading.step()
    assert (reading.failure, reading.latest) == ("", 3.0)


def test_refused_measurements_are_counted_by_name_and_change_nothing():
    spoiled = UnfitMeasurement("wrong checksum"), UnfitMeasurement("wrong checksum"), UnfitMeasurement("cut off", "3")
    reading = reading_of(Source([1.0, *spoiled]), threaded=False)
    for _ in range(4):
        reading.step()
    assert reading.refused == {"wrong checksum": 2, "cut off": 1}
    assert (reading.failure, reading.latest) == ("cut off (3)", 1.0)


def test_the_rate_is_that_of_the_last_measurements():
    now = iter([*range(100)])
    reading = reading_of(Source(range(60)), clock=lambda: 0.5 * next(now), threaded=False)
    assert reading.rate_hz is None
    for _ in range(60):
        reading.step()
    assert reading.rate_hz == pytest.approx(2.0)
    assert len(reading._times) <= 2 * KEPT + 1


@pytest.mark.parametrize(
    ("times", "told"),
    [
        ((), "rate not known"),
        ((7.0,), "rate not known"),
        (tuple(7.0 + 0.00027 * k for k in range(20)), "rate not known"),  # a burst of 3 700 a second
        (tuple(0.1 * k for k in range(21)), "10 Hz"),
        ((0.0, 4.0), "0.2 Hz"),
    ],
)
def test_a_rate_is_told_of_a_second_at_least(times, told):
    assert rate_told(rate_of(times)) == told


def test_a_thread_reads_until_it_is_closed():
    source = Source(range(1000))
    reading = reading_of(source)
    reading.close()
    assert source.closed
    assert not any(thread.name == "numbers" for thread in threading.enumerate())


class Eyes:
    """See sand everywhere, and keep what they were told."""

    def perceive(self, rgb, camera, attitude):
        self.given = camera, attitude
        shape = rgb.shape[:2]
        sand = np.full(shape, Label.SEABED, np.uint8)
        return SeenPicture(sand, np.full(shape, 2.0, np.float32), np.zeros(shape, np.float32))


def rgb(stamp):
    return Shot(stamp_s=stamp, rgb=np.zeros((2, 2, 3), np.uint8))


SMALL = CameraCfg(width=2, height=2)


def test_the_newest_picture_is_kept_with_what_eyes_see_in_it():
    eyes, times = Eyes(), iter([5.0, 5.25, 6.0])
    camera = LatestShot(Source([rgb(1.0), None, rgb(2.0)]), eyes, SMALL, threaded=False)
    camera.attitude = lambda: CameraAttitude(height=1.5)
    camera.step()
    camera.step()
    camera._clock = lambda: next(times)
    camera.step()
    assert camera.latest.stamp_s == 2.0  # when it was taken, not when eyes were done
    assert camera.seeing_s == 0.25
    assert camera.latest.frame.depth.tolist() == [[2.0, 2.0], [2.0, 2.0]]
    assert camera.latest.frame.rgb is camera.latest.rgb  # so that the record has colours
    assert eyes.given == (SMALL, CameraAttitude(height=1.5))


def test_eyes_replace_what_the_simulated_camera_knows():
    shown = replace(FRAME, rgb=np.zeros((2, 2, 3), np.uint8))
    camera = LatestShot(Source([Shot(stamp_s=1.0, frame=shown)]), Eyes(), SMALL, threaded=False)
    camera.step()
    assert (camera.latest.frame.labels == Label.SEABED).all()


def test_without_eyes_a_picture_has_no_frame():
    camera = LatestShot(Source([rgb(1.0)]), threaded=False)
    camera.step()
    assert camera.latest.frame is None
