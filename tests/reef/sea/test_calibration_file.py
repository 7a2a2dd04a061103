"""Calibrations of other tools are read as what they mean."""

import pytest

from coral.errors import InputError
from coral.reef.sea.calibration_file import own_keys

ROS = {
    "image_width": 160,
    "image_height": 120,
    "camera_name": "left",
    "camera_matrix": {"rows": 3, "cols": 3, "data": [52.0, 0.0, 81.0, 0.0, 51.5, 58.5, 0.0, 0.0, 1.0]},
    "distortion_model": "plumb_bob",
    "distortion_coefficients": {"rows": 1, "cols": 5, "data": [-0.05, 0.004, 0.0, 0.0, 0.0]},
}
KALIBR = {
    "camera_model": "pinhole",
    "intrinsics": [52.0, 51.5, 81.0, 58.5],
    "distortion_model": "equi",
    "distortion_coeffs": [0.1, 0.0, 0.0, 0.0],
    "resolution": [160, 120],
}
SAME = {"width": 160, "height": 120, "fx": 52.0, "fy": 51.5, "cx": 81.0, "cy": 58.5}


def test_a_file_of_ros_and_one_of_kalibr():
    assert own_keys(ROS, "f") == {**SAME, "model": "plumb_bob", "distortion": [-0.05, 0.004, 0.0, 0.0, 0.0]}
    assert own_keys({"cam0": KALIBR}, "f") == {**SAME, "model": "equidistant", "distortion": [0.1, 0.0, 0.0, 0.0]}


def test_a_file_of_ours_stays_but_for_names_of_models():
    assert own_keys({"width": 5, "model": "radtan"}, "f") == {"width": 5, "model": "plumb_bob"}
    assert own_keys({"fov": 5}, "f") == {"fov": 5}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({**ROS, "camera_matrix": {"data": [1.0] * 8}}, "camera_matrix: data: found .* expected 9 numbers"),
        ({**ROS, "camera_matrix": "?"}, "camera_matrix: data: found None"),
        ({key: ROS[key] for key in ROS if key != "image_width"}, "image_width: found nothing"),
        ({"cam0": KALIBR, "cam1": KALIBR}, "found the cameras cam0, cam1"),
        ({"cam0": {**KALIBR, "camera_model": "omni"}}, "cam0: camera_model: found 'omni'"),
    ],
)
def test_what_is_not_whole_is_named(content, said):
    with pytest.raises(InputError, match=said):
        own_keys(content, "f")
