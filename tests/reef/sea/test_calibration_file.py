"""Calibrations of other tools are read as what they mean."""

import json

import pytest

from coral.errors import InputError
from coral.reef.sea.calibration_file import own_keys, read_calibration

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


OPENCV = {**{key: ROS[key] for key in ("image_width", "image_height", "camera_matrix", "distortion_coefficients")}}
YAML = """%YAML:1.0
---
calibration_time: "Wed 04 May 2023 05:16:40 PM UTC"
image_width: 160
image_height: 120
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.2000000000000000e+001, 0., 81., 0., 51.5, 58.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.05, 4.0000000000000001e-03, 0., 0., 0. ]
pitch_down_deg: 30
"""
XML = """<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Wed 04 May"</calibration_time>
<image_Width>160</image_Width> <image_Height>120</image_Height>
<Camera_Matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt><data>
  52. 0. 81. 0. 51.5 58.5 0. 0. 1.</data></Camera_Matrix>
<Distortion_Coefficients type_id="opencv-matrix"><rows>5</rows><cols>1</cols><dt>d</dt><data>
  -0.05 0.004 0. 0. 0.</data></Distortion_Coefficients>
<pitch_down_deg>30</pitch_down_deg>
</opencv_storage>
"""
FOUND = {**SAME, "model": "plumb_bob", "distortion": [-0.05, 0.004, 0.0, 0.0, 0.0], "pitch_down_deg": 30}


def read(tmp_path, text, name="lens.yaml"):
    (tmp_path / name).write_text(text)
    return read_calibration(tmp_path / name)


def test_what_opencv_writes_as_yaml_xml_or_json_is_the_same_camera(tmp_path):
    assert read(tmp_path, YAML) == read(tmp_path, XML, "lens.xml") == FOUND
    assert read(tmp_path, json.dumps({**OPENCV, "pitch_down_deg": 30}, indent=4), "lens.json") == FOUND


def test_what_opencv_itself_wrote_is_read(tmp_path):
    cv2 = pytest.importorskip("cv2")
    np = pytest.importorskip("numpy")
    for name in ("own.yml", "own.xml", "own.json"):
        store = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_WRITE)
        store.write("image_width", 160)
        store.write("image_height", 120)
        store.write("fisheye_model", 1)
        store.write("camera_matrix", np.array([[52.0, 0, 81], [0, 51.5, 58.5], [0, 0, 1]]))
        store.write("distortion_coefficients", np.array([[0.1, 0.02, -1e-7, 0.0]]))
        store.release()
        found = read_calibration(tmp_path / name)
        assert found == {**SAME, "model": "equidistant", "distortion": [0.1, 0.02, -1e-7, 0.0]}


def test_many_coefficients_of_opencv_are_the_rational_model():
    many = {**OPENCV, "distortion_coefficients": {"data": [0.1] * 8}}
    assert own_keys(many, "f")["model"] == "rational_polynomial"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<?xml version='1.0'?><!DOCTYPE a [<!ENTITY b 'c'>]><opencv_storage/>", "XML with definitions of its own"),
        ("<svg/>", "found XML of <svg>, expected <opencv_storage>"),
        ("<opencv_storage><camera_matrix>", "broken XML"),
        ("<opencv_storage><camera_matrix><data>1 2</data></camera_matrix></opencv_storage>", "expected 9 numbers"),
        (YAML.replace("image_width", "image_wide"), "image_width: found nothing, expected the size of the pictures"),
        (YAML.replace("81.", "eighty"), "camera_matrix: data: found"),
        ("%YAML:1.0\n---\ncamera_matrix: [", r"lens\.yaml"),
    ],
)
def test_a_broken_file_of_opencv_is_one_line(tmp_path, text, said):
    with pytest.raises(InputError, match=said) as told:
        read(tmp_path, text)
    assert "\n" not in str(told.value)
