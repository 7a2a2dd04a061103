from dataclasses import replace

import numpy as np

from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.sea.picture import LatestShot, Shot
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label

FRAME = Frame(np.zeros((2, 2), np.float32), np.zeros((2, 2), np.uint8), np.full((2, 2), -1, np.int32))


class Source:
    name = "test, 2x2"

    def __init__(self, shots):
        self.shots, self.closed = list(shots), False

    def read(self):
        shot = self.shots.pop(0)
        if isinstance(shot, Exception):
            raise shot
        return shot

    def close(self):
        self.closed = True


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
