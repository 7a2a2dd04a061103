"""Camera files."""

import json
import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.lens import Lens
from coral.reef.sea.recorded_camera import (
    RecordedCamera,
    Rectifier,
    read_calibration,
    read_camera,
    rectified_size,
)
from coral.reef.vehicle.camera import CameraCfg

PLAIN = Lens(width=64, height=48, fx=40.0, fy=40.0, cx=31.5, cy=23.5)
BARREL = replace(PLAIN, distortion=(-0.2, 0.03, 0.0, 0.0, 0.0))
FISHEYE = replace(PLAIN, fx=25.0, fy=25.0, model="equidistant", distortion=(0.0, 0.0, 0.0, 0.0))


def camera(tmp_path, text):
    (tmp_path / "camera.yaml").write_text(text)
    return read_camera(tmp_path / "camera.yaml")


def test_a_field_of_view_is_enough_and_nothing_is_rectified(tmp_path):
    found = camera(tmp_path, "{width: 640, height: 480, hfov_deg: 80, pitch_down_deg: 30, altitude_m: 1.5}")
    assert found.view == CameraCfg(width=640, height=480, hfov_deg=80.0, pitch_down_deg=30.0, altitude_m=1.5)
    assert found.rectifier is None
    assert found.size == (640, 480)


def test_a_calibration_makes_pictures_of_a_pinhole_camera(tmp_path):
    text = "{width: 640, height: 480, fx: 520, fy: 518, cx: 310, cy: 250, distortion: [-0.3, 0.1, 0, 0]}"
    found = camera(tmp_path, text)
    assert found.rectifier is not None
    assert found.size == (640, 480)
    assert found.view.pitch_down_deg == 15.0
    # The barrel shows more than 640 / 520 at its sides: the view is wider than without distortion.
    assert found.view.hfov_deg > 62.0


def test_a_camera_of_ours_is_taken_as_it_is():
    cfg = CameraCfg(width=80, height=60)
    assert RecordedCamera.plain(cfg) == RecordedCamera(cfg, (80, 60))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{fx: 100}", "fx, fy: found one without the other"),
        ("{fx: 100, fy: 100, hfov_deg: 90}", "hfov_deg: found fx, fy besides"),
        ("{distortion: [0.1, 0, 0, 0]}", "distortion: found no fx, fy"),
        ("{fov: 100}", "camera.yaml: fov: found an unknown key"),
        ("{width: -3}", "width"),
        pytest.param(f"{{width: 1{'0' * 400}}}", "width", id="a width of 400 digits"),
        ("{hfov_deg: 200}", "hfov_deg: found 200"),
        ("{fx: 100, fy: 100, model: kannala}", "model"),
        ("{width: 640, height: 480, fx: 400, fy: 4}", "fx, fy: found 400 and 4, expected focal lengths of one camera"),
    ],
)
def test_a_file_that_is_wrong_names_the_field(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        camera(tmp_path, text)


def test_pictures_are_rectified_and_reduced_at_once(tmp_path):
    path = tmp_path / "camera.yaml"
    path.write_text("width: 1280\nheight: 720\nfx: 900\nfy: 900\ndistortion: [-0.2, 0.05, 0, 0]\npitch_down_deg: 20\n")
    found = read_camera(path, most_width=320)
    assert (found.view.width, found.view.pitch_down_deg) == (320, 20.0)
    assert 60.0 < found.view.hfov_deg < 90.0
    picture = found.picture(np.full((720, 1280, 3), 80, np.uint8))
    assert picture.shape == (found.view.height, 320, 3)
    assert (picture == 80).mean() > 0.95
    with pytest.raises(ValueError, match="640x480 px, where the camera file says 1280x720"):
        found.picture(np.zeros((480, 640, 3), np.uint8))


def test_a_plain_lens_keeps_its_size_and_field_of_view():
    assert PLAIN.is_plain
    assert rectified_size(PLAIN, "x") == (64, 48, pytest.approx(2 * math.degrees(math.atan(32 / 40)), abs=1e-8))


def test_large_pictures_are_reduced():
    lens = Lens(width=2560, height=1440, fx=1000.0, fy=1000.0, cx=1279.5, cy=719.5)
    width, height, hfov = rectified_size(lens, "x")
    assert (width, height) == (1280, 720)
    assert hfov == pytest.approx(2 * math.degrees(math.atan(1.28)))
    rgb = np.zeros((1440, 2560, 3), np.uint8)
    rgb[:, 1280:] = 200
    made = Rectifier(lens, CameraCfg(width=1280, height=720, hfov_deg=hfov)).colours(rgb)
    assert (made[300, 630, 0], made[300, 650, 0]) == (0, 200)


@pytest.mark.parametrize("lens", [BARREL, FISHEYE, replace(PLAIN, fx=44.0, cx=28.0)])
def test_a_point_lands_where_a_pinhole_camera_sees_it(lens):
    assert not lens.is_plain
    width, height, hfov = rectified_size(lens, "x")
    view = CameraCfg(width=width, height=height, hfov_deg=hfov)
    ray = np.array([[[0.3, -0.2, 1.0]]])
    project = cv2.fisheye.projectPoints if lens.model == "equidistant" else cv2.projectPoints
    at, _ = project(ray, np.zeros(3), np.zeros(3), lens.matrix, np.array(lens.distortion or (0.0,) * 4))
    u, v = at.ravel()
    # A picture whose brightness is a paraboloid about the point: its least value is where the point lies.
    rows, columns = np.indices((lens.height, lens.width))
    image = np.minimum(8.0 * ((columns - u) ** 2 + (rows - v) ** 2), 255.0).astype(np.uint8)
    made = Rectifier(lens, view).colours(np.dstack([image] * 3))[..., 0]
    row, column = np.unravel_index(np.argmin(made.astype(int)), made.shape)
    focal, _, cx, cy = view.intrinsics
    assert (column, row) == (pytest.approx(cx + 0.3 * focal, abs=1.0), pytest.approx(cy - 0.2 * focal, abs=1.0))


def test_a_fisheye_is_cut_at_the_widest_view():
    assert rectified_size(replace(FISHEYE, fx=18.0, fy=18.0), "x")[2] == 120.0


def test_classes_are_not_mixed_and_nothing_is_seen_outside():
    pincushion = replace(PLAIN, distortion=(0.4, 0.0, 0.0, 0.0))
    width, height, hfov = rectified_size(pincushion, "x")
    rectifier = Rectifier(pincushion, CameraCfg(width=width, height=height, hfov_deg=hfov))
    made = rectifier.values(np.full((48, 64), 3, np.uint8))
    assert set(np.unique(made)) <= {0, 3}
    assert (made == 0).tolist() == rectifier.outside.tolist()
    assert not rectifier.outside[height // 2, width // 2]


ROS = {
    "image_width": 160,
    "image_height": 120,
    "camera_name": "left",
    "camera_matrix": {"rows": 3, "cols": 3, "data": [52.0, 0.0, 81.0, 0.0, 51.5, 58.5, 0.0, 0.0, 1.0]},
    "distortion_model": "plumb_bob",
    "distortion_coefficients": {"rows": 1, "cols": 5, "data": [-0.05, 0.004, 0.0, 0.0, 0.0]},
    "pitch_down_deg": 30,
}
OPENCV = {key: value for key, value in ROS.items() if key != "distortion_model"}
SAME = {"width": 160, "height": 120, "fx": 52.0, "fy": 51.5, "cx": 81.0, "cy": 58.5}
FOUND = {**SAME, "model": "plumb_bob", "distortion": [-0.05, 0.004, 0.0, 0.0, 0.0], "pitch_down_deg": 30}
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


def read(tmp_path, text):
    (tmp_path / "lens.yaml").write_text(text)
    return read_calibration(tmp_path / "lens.yaml")


def test_a_calibration_of_ros_or_opencv_is_the_same_camera(tmp_path):
    assert read(tmp_path, json.dumps(ROS)) == read(tmp_path, json.dumps(OPENCV, indent=4)) == FOUND
    assert read(tmp_path, YAML) == FOUND
    assert read_camera(tmp_path / "lens.yaml").view.pitch_down_deg == 30.0
    assert read(tmp_path, "fov: 5") == {"fov": 5}


def test_what_opencv_itself_wrote_is_read(tmp_path):
    for name in ("own.yml", "own.json"):
        store = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_WRITE)
        store.write("image_width", 160)
        store.write("image_height", 120)
        store.write("fisheye_model", 1)
        store.write("camera_matrix", np.array([[52.0, 0, 81], [0, 51.5, 58.5], [0, 0, 1]]))
        store.write("distortion_coefficients", np.array([[0.1, 0.02, -1e-7, 0.0]]))
        store.release()
        found = read_calibration(tmp_path / name)
        assert found == {**SAME, "model": "equidistant", "distortion": [0.1, 0.02, -1e-7, 0.0]}


def test_many_coefficients_of_opencv_are_the_rational_model(tmp_path):
    many = {**OPENCV, "distortion_coefficients": {"data": [0.1] * 8}}
    assert read(tmp_path, json.dumps(many))["model"] == "rational_polynomial"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (json.dumps({**ROS, "camera_matrix": {"data": [1.0] * 8}}), "camera_matrix: data: found .* expected 9 numbers"),
        (json.dumps({**ROS, "camera_matrix": "?"}), "camera_matrix: data: found None"),
        (YAML.replace("image_width", "image_wide"), "image_width: found nothing, expected the size of the pictures"),
        (YAML.replace("81.", "eighty"), "camera_matrix: data: found"),
        ("%YAML:1.0\n---\ncamera_matrix: [", r"lens\.yaml"),
        ("<opencv_storage><camera_matrix>", r"lens\.yaml"),
    ],
)
def test_a_broken_calibration_is_one_line(tmp_path, text, said):
    with pytest.raises(InputError, match=said) as told:
        read(tmp_path, text)
    assert "\n" not in str(told.value)
