"""Pictures and lenses in ROS messages."""

import struct
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from coral.drawing import jpeg, png
from coral.errors import InputError
from coral.lens import Lens, check_lens
from coral.ros.camera_pictures import colours_in, lens_of, values_in
from reef.ros.fake_ros import info

RED = np.zeros((2, 4, 3), np.uint8)
RED[...] = (200, 30, 10)
RAW = "/front/image_raw"
WIDE = {"distortion_model": "plumb_bob", "d": [-0.3, 0.1, 0.001, 0.002, 0.0]}


def plain(encoding, rows, step=None, big=0):
    """A message whose rows may be longer than their pixels."""
    raw = np.ascontiguousarray(rows).view(np.uint8).reshape(len(rows), -1)
    padded = np.zeros((len(rows), step or raw.shape[1]), np.uint8)
    padded[:, : raw.shape[1]] = raw
    return SimpleNamespace(
        encoding=encoding, height=rows.shape[0], width=rows.shape[1], step=padded.shape[1], is_bigendian=big,
        data=padded.ravel(),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("encoding", "rows"),
    [
        ("rgb8", RED),
        ("bgr8", RED[..., ::-1]),
        ("rgba8", np.dstack([RED, RED[..., :1]])),
        ("bgra8", np.dstack([RED[..., ::-1], RED[..., :1]])),
    ],
)
@pytest.mark.parametrize("step", [None, 64])
def test_plain_colours_come_out_red_first_whatever_the_length_of_a_row(encoding, rows, step):
    np.testing.assert_array_equal(colours_in(plain(encoding, rows, step), "x"), RED)


def test_bayer_patterns_are_those_of_ros():
    mosaic = np.zeros((8, 8), np.uint8)
    mosaic[0::2, 0::2] = 200  # rggb: red in the first row and column
    made = colours_in(plain("bayer_rggb8", mosaic), "x")[4, 4]
    assert made[0] > 90 > made[2]


def test_yuv_is_read():
    packed = np.full((2, 4, 2), (128, 90), np.uint8)  # u or v, y
    made = colours_in(plain("yuv422", packed), "x")
    assert made.shape == (2, 4, 3)
    assert np.ptp(made[0, 0].astype(int)) <= 2  # gray


def test_compressed_colours_are_read():
    message = SimpleNamespace(format="jpeg", data=np.frombuffer(jpeg(np.repeat(RED, 8, 0)), np.uint8))
    assert np.abs(colours_in(message, "x").astype(int) - (200, 30, 10)).max() < 12


def test_depth_keeps_its_values_in_both_byte_orders_and_behind_a_header():
    depth = np.array([[1000, 2500], [0, 65535]], np.uint16)
    np.testing.assert_array_equal(values_in(plain("16UC1", depth), "x", "depth"), depth)
    np.testing.assert_array_equal(values_in(plain("mono16", depth.byteswap(), big=1), "x", "depth"), depth)
    metres = np.array([[1.5, np.nan]], np.float32)
    np.testing.assert_array_equal(values_in(plain("32FC1", metres), "x", "depth"), metres)
    packed = b"\0" * 12 + png(depth)
    message = SimpleNamespace(format="16UC1; compressedDepth png", data=np.frombuffer(packed, np.uint8))
    np.testing.assert_array_equal(values_in(message, "x", "depth"), depth)


def test_a_depth_of_32_bits_is_kept_as_inverse_depths():
    a, b = 101.0, 1.5
    raw = np.array([[0, 50, 10_000]], np.uint16)
    packed = struct.pack("<iff", 0, a, b) + png(raw)
    message = SimpleNamespace(format="32FC1; compressedDepth png", data=np.frombuffer(packed, np.uint8))
    np.testing.assert_allclose(values_in(message, "x", "depth"), [[np.nan, a / 48.5, a / 9998.5]], rtol=1e-6)


@pytest.mark.parametrize(
    ("form", "size", "said"), [("32FC1; compressedDepth rvl", 99, "as RVL"), ("16UC1; compressedDepth", 12, "12 bytes")]
)
def test_a_compressed_depth_that_is_not_read_is_named(form, size, said):
    with pytest.raises(InputError, match=said):
        values_in(SimpleNamespace(format=form, data=np.zeros(size, np.uint8)), "x", "depth")


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (plain("jpeg2000", RED), "encoding: found 'jpeg2000', expected one of mono8"),
        (plain("32FC1", np.zeros((2, 2), np.float32)), "encoding: found '32FC1', expected one of rgb8"),
        (SimpleNamespace(**{**vars(plain("rgb8", RED)), "height": 9}), "data: found 24 bytes, expected 9 rows of 12"),
        (SimpleNamespace(**{**vars(plain("rgb8", RED)), "step": 3}), "data: found"),
        (SimpleNamespace(**{**vars(plain("rgb8", RED)), "width": 0}), "data: found"),
        (SimpleNamespace(format="jpeg", data=np.zeros(9, np.uint8)), "found no picture"),
        (SimpleNamespace(format="h264", data=np.zeros(9, np.uint8)), "format: found 'h264', expected JPEG or PNG"),
    ],
)
def test_a_message_that_lies_is_one_line(message, said):
    with pytest.raises(InputError, match=said):
        colours_in(message, "x")


def test_opencv_has_the_conversions_that_ros_names():
    assert cv2.COLOR_YUV2RGB_UYVY == cv2.COLOR_YUV2RGB_Y422


def test_a_lens_is_that_of_k_and_d():
    assert lens_of(info(**WIDE), RAW) == Lens(
        width=8, height=4, fx=4.0, fy=4.0, cx=3.5, cy=1.5, model="plumb_bob", distortion=(-0.3, 0.1, 0.001, 0.002, 0.0)
    )


@pytest.mark.parametrize(
    ("name", "count", "model"),
    [
        ("plumb_bob", 5, "plumb_bob"),
        ("", 0, "plumb_bob"),
        ("rational_polynomial", 8, "rational_polynomial"),
        ("equidistant", 4, "equidistant"),
        ("fisheye", 4, "equidistant"),
    ],
)
def test_models_are_named_as_in_sensor_msgs(name, count, model):
    message = info(distortion_model=name, d=[0.01] * count)
    assert lens_of(message, RAW).model == model
    assert check_lens(lens_of(message, RAW), "info")


def test_rectified_pictures_are_of_p():
    p = [5.0, 0.0, 3.0, 0.0, 0.0, 6.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    lens = lens_of(info(**WIDE, p=p), "/front/image_rect")
    assert (lens.fx, lens.fy, lens.cx, lens.cy, lens.distortion) == (5.0, 6.0, 3.0, 1.0, ())


def test_a_part_of_the_sensor_and_binned_pixels():
    whole = info(width=16, height=8, k=[8.0, 0.0, 7.5, 0.0, 8.0, 3.5, 0.0, 0.0, 1.0], binning_x=2, binning_y=2)
    assert lens_of(whole, RAW) == lens_of(info(d=[0.0] * 5), RAW)
    whole.roi.x_offset, whole.roi.y_offset, whole.roi.width, whole.roi.height = 4, 2, 8, 4
    lens = lens_of(whole, RAW)
    assert (lens.width, lens.height, lens.cx, lens.cy) == (4, 2, 1.5, 0.5)


def test_ros_1_writes_the_matrices_with_capitals():
    there = vars(info(**WIDE))
    old = SimpleNamespace(**{name.upper() if name in "kdp" else name: value for name, value in there.items()})
    assert lens_of(old, RAW) == lens_of(info(**WIDE), RAW)
