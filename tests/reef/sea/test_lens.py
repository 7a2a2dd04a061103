"""Lenses and rectified pictures."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from coral.lens import Lens
from coral.reef.sea.lens import Rectifier, rectified_size
from coral.reef.vehicle.camera import CameraCfg

PLAIN = Lens(width=64, height=48, fx=40.0, fy=40.0, cx=31.5, cy=23.5)
BARREL = replace(PLAIN, distortion=(-0.2, 0.03, 0.0, 0.0, 0.0))
FISHEYE = replace(PLAIN, fx=25.0, fy=25.0, model="equidistant", distortion=(0.0, 0.0, 0.0, 0.0))


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
