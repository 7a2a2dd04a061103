"""Pictures as files."""

import os

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.recordings.picture_files import (
    colours_of,
    depth_of,
    encode_depth,
    encode_jpeg,
    encode_png,
    labels_of,
    read_picture,
)
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg

CAMERA = RecordedCamera.plain(CameraCfg(width=4, height=3))


@pytest.fixture
def stored(tmp_path):
    def store(content, field):
        (tmp_path / "picture").write_bytes(content)
        return read_picture(tmp_path / "picture", "x", field)

    return store


def test_depth_comes_back_in_millimetres_and_nothing_seen_stays_nothing(stored):
    depth = np.array([[0.2504, 1.5, 3.0, 12.0], [np.inf] * 4, [70.0] * 4], np.float32)
    read = depth_of(stored(encode_png(encode_depth(depth)), "depth"), CAMERA, "x")
    np.testing.assert_allclose(read[0], [0.25, 1.5, 3.0, 12.0])
    assert np.isinf(read[1]).all()
    assert (read[2] == np.float32(65.535)).all()


def test_labels_come_back_as_they_were(stored):
    labels = np.arange(12, dtype=np.uint8).reshape(3, 4) % 4
    np.testing.assert_array_equal(labels_of(stored(encode_png(labels), "labels"), CAMERA, "x"), labels)


def test_colours_keep_their_order(stored):
    rgb = np.zeros((3, 4, 3), np.uint8)
    rgb[..., 0] = 200
    read = colours_of(stored(encode_jpeg(rgb), "rgb"), CAMERA, "x")
    assert read[..., 0].min() > 180
    assert read[..., 2].max() < 30


def test_pixels_stay_as_they_lie_in_the_file_whatever_orientation_it_tells(stored):
    rgb = np.zeros((3, 4, 3), np.uint8)
    rgb[0] = 250
    plain = encode_jpeg(rgb)
    exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0"  # 3: turned by 180 degrees
    turned = plain[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + plain[2:]
    np.testing.assert_array_equal(stored(turned, "rgb"), stored(plain, "rgb"))


@pytest.mark.parametrize(
    ("as_kind", "image", "said"),
    [
        (labels_of, np.full((3, 4), 9, np.uint8), "classes 0 to 3"),
        (labels_of, np.zeros((3, 4), np.uint16), "8 bits in one channel"),
        (depth_of, np.zeros((3, 4), np.uint8), "millimetres, 16 bits"),
        (depth_of, np.zeros((6, 8), np.uint16), "found 8 x 6 pixels, expected 4 x 3"),
    ],
)
def test_a_picture_of_another_kind_is_refused(as_kind, image, said):
    with pytest.raises(InputError, match=said):
        as_kind(image, CAMERA, "x")


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
    np.testing.assert_array_equal(depth_of(image, CAMERA, "x")[0], np.array([1.5, np.inf, np.inf, 2.0], np.float32))
