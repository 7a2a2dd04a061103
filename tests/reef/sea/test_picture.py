import numpy as np

from coral.reef.sea.picture import LatestShot, Shot
from coral.reef.world.geometry import Frame

FRAME = Frame(np.zeros((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.full((2, 2), -1, np.int32))


class Source:
    name, labelled = "test, 2x2", False

    def __init__(self, shots):
        self.shots, self.closed = list(shots), False

    def read(self):
        shot = self.shots.pop(0)
        if isinstance(shot, Exception):
            raise shot
        return shot

    def close(self):
        self.closed = True


class Perceiver:
    name = "constant"

    def perceive(self, rgb):
        return FRAME


def rgb(stamp):
    return Shot(stamp_s=stamp, rgb=np.zeros((2, 2, 3), np.uint8))


def test_the_newest_picture_is_kept_and_perceived():
    camera = LatestShot(Source([rgb(1.0), None, rgb(2.0)]), Perceiver(), threaded=False)
    for _ in range(3):
        camera.step()
    assert camera.latest.stamp_s == 2.0
    assert camera.latest.frame.depth is FRAME.depth
    assert camera.latest.frame.rgb is camera.latest.rgb  # so that the record has colours


def test_without_perception_a_picture_has_no_frame():
    camera = LatestShot(Source([rgb(1.0)]), threaded=False)
    camera.step()
    assert camera.latest.frame is None


def test_a_broken_camera_says_why_and_comes_back():
    camera = LatestShot(Source([rgb(1.0), OSError("no signal"), rgb(3.0)]), threaded=False)
    camera._closing.set()  # no pause after the error
    camera.step()
    camera.step()
    assert camera.failure == "no signal"
    assert camera.latest.stamp_s == 1.0  # it grows old, which the guard sees
    camera.step()
    assert (camera.failure, camera.latest.stamp_s) == ("", 3.0)


def test_the_rate_is_measured():
    now = iter(0.1 * k for k in range(100))
    camera = LatestShot(Source([rgb(k) for k in range(10)]), clock=lambda: next(now), threaded=False)
    for _ in range(10):
        camera.step()
    assert round(camera.rate_hz, 6) == 10.0


def test_closing_frees_the_camera():
    source = Source([])
    LatestShot(source, threaded=False).close()
    assert source.closed
