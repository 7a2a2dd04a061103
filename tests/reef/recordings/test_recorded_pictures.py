"""What pictures of a recording show."""

import os

import numpy as np
import pytest
from given_eyes import FlatEyes

from coral.drawing import jpeg, png
from coral.errors import InputError
from coral.lens import Lens
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.recordings.recorded_pictures import PicturePerception, encode_depth, read_picture, rectify
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg

CAMERA = RecordedCamera.plain(CameraCfg(width=4, height=3))
FLAT = RecordedCamera.plain(CameraCfg(width=8, height=6))
RGB = np.full((6, 8, 3), 70, np.uint8)


@pytest.fixture
def stored(tmp_path):
    def store(content, field):
        (tmp_path / "picture").write_bytes(content)
        return read_picture(tmp_path / "picture", "x", field)

    return store


def test_depth_comes_back_in_millimetres_and_nothing_seen_stays_nothing(stored):
    depth = np.array([[0.2504, 1.5, 3.0, 12.0], [np.inf] * 4, [70.0] * 4], np.float32)
    read = rectify(stored(png(encode_depth(depth)), "depth"), CAMERA, "x", "depth")
    np.testing.assert_allclose(read[0], [0.25, 1.5, 3.0, 12.0])
    assert np.isinf(read[1]).all()
    assert (read[2] == np.float32(65.535)).all()


def test_labels_come_back_as_they_were(stored):
    labels = np.arange(12, dtype=np.uint8).reshape(3, 4) % 4
    np.testing.assert_array_equal(rectify(stored(png(labels), "labels"), CAMERA, "x", "labels"), labels)


def test_colours_keep_their_order(stored):
    rgb = np.zeros((3, 4, 3), np.uint8)
    rgb[..., 0] = 200
    read = rectify(stored(jpeg(rgb), "rgb"), CAMERA, "x", "rgb")
    assert read[..., 0].min() > 180
    assert read[..., 2].max() < 30


def test_pixels_stay_as_they_lie_in_the_file_whatever_orientation_it_tells(stored):
    rgb = np.zeros((3, 4, 3), np.uint8)
    rgb[0] = 250
    plain = jpeg(rgb)
    exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0"  # 3: turned by 180 degrees
    turned = plain[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + plain[2:]
    np.testing.assert_array_equal(stored(turned, "rgb"), stored(plain, "rgb"))


@pytest.mark.parametrize(
    ("field", "image", "said"),
    [
        ("labels", np.full((3, 4), 9, np.uint8), "classes 0 to 3"),
        ("labels", np.zeros((3, 4), np.uint16), "8 bits in one channel"),
        ("depth", np.zeros((3, 4), np.uint8), "millimetres, 16 bits"),
        ("depth", np.zeros((6, 8), np.uint16), "found 8 x 6 pixels, expected 4 x 3"),
    ],
)
def test_a_picture_of_another_kind_is_refused(field, image, said):
    with pytest.raises(InputError, match=said):
        rectify(image, CAMERA, "x", field)


def test_no_picture_is_refused(tmp_path, stored):
    with pytest.raises(InputError, match="found no picture"):
        stored(b"text", "rgb")
    with pytest.raises(InputError, match=r"gone\.png"):
        read_picture(tmp_path / "gone.png", "x", "rgb")


def test_a_pipe_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(InputError, match=r"pipe\.png: a named pipe"):
        read_picture(tmp_path / "pipe.png", "x", "rgb")


def test_depth_in_metres_is_read_too():
    image = np.array([[1.5, np.nan, 0.0, 2.0]] * 3, np.float32)
    np.testing.assert_array_equal(
        rectify(image, CAMERA, "x", "depth")[0], np.array([1.5, np.inf, np.inf, 2.0], np.float32)
    )


def test_each_picture_is_looked_at_once_and_stays_the_same():
    eyes = FlatEyes(doubt=0.25)
    perception = PicturePerception(eyes, "flat")
    first, again = (perception.frame(RGB, FLAT, CameraAttitude(0.8), "line 2") for _ in range(2))
    perception.frame(RGB, FLAT, CameraAttitude(1.6), "line 3")
    assert eyes.looks == 2
    for name in ("labels", "depth", "doubt", "rgb"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
    assert first.doubt.max() - 0.25 < 1 / 255
    np.testing.assert_allclose(first.depth[-1], ground_depth(FLAT.view, 0.8)[-1], atol=0.001)


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
