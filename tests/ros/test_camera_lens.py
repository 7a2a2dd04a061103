from types import SimpleNamespace

import pytest

from coral.lens import Lens, check_lens
from coral.ros.camera_lens import lens_of
from reef.ros.fake_ros import info

RAW = "/front/image_raw"
WIDE = {"distortion_model": "plumb_bob", "d": [-0.3, 0.1, 0.001, 0.002, 0.0]}


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
