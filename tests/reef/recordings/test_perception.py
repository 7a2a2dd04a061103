"""Colour pictures of a recording, seen once."""

import numpy as np
from given_eyes import FlatEyes

from coral.lens import Lens
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.recordings.perception import PicturePerception
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg

CAMERA = RecordedCamera.plain(CameraCfg(width=8, height=6))
RGB = np.full((6, 8, 3), 70, np.uint8)


def test_each_picture_is_looked_at_once_and_stays_the_same():
    eyes = FlatEyes(doubt=0.25)
    perception = PicturePerception(eyes, "flat")
    first, again = (perception.frame(RGB, CAMERA, CameraAttitude(0.8), "line 2") for _ in range(2))
    perception.frame(RGB, CAMERA, CameraAttitude(1.6), "line 3")
    assert eyes.looks == 2
    for name in ("labels", "depth", "doubt", "rgb"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
    assert first.doubt.max() - 0.25 < 1 / 255
    np.testing.assert_allclose(first.depth[-1], ground_depth(CAMERA.view, 0.8)[-1], atol=0.001)


def test_eyes_know_the_rectified_camera_and_see_nothing_outside_it():
    lens = Lens(width=64, height=48, fx=40.0, fy=40.0, cx=31.5, cy=23.5, distortion=(0.4, 0.0, 0.0, 0.0))
    camera = RecordedCamera.of(lens, CameraCfg(), "x")
    eyes = FlatEyes()
    rgb = np.zeros((camera.view.height, camera.view.width, 3), np.uint8)
    seen = PicturePerception(eyes, "flat").frame(rgb, camera, CameraAttitude(1.0), "x")
    assert eyes.camera == camera.view
    outside = camera.rectifier.outside
    assert outside.any()
    assert (seen.labels[outside] == 0).all()
    assert np.isinf(seen.depth[outside]).all()
    assert (seen.labels[~outside] == 3).all()
