"""The hot loop of a mosaic."""

import numpy as np
import pytest

from coral.reef.pictures.mosaic_kernels import paint
from coral.reef.recordings.transforms import body_transform, camera_in_body
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

CAMERA = CameraCfg(width=80, height=60, pitch_down_deg=90.0)
FOCAL, _, CX, CY = CAMERA.intrinsics


def painted(looks, hidden_by=None):
    """Paint looks straight down from (2, 2): height, shade and detail of each. Return shade and detail."""
    best, weight = np.full((40, 40), np.inf, np.float32), np.zeros((40, 40), np.float32)
    shade, fine = np.zeros((40, 40, 3), np.float32), np.zeros((40, 40, 3), np.float32)
    for height, coarse, detail in looks:
        transform = body_transform(Pose(2.0, 2.0, 0.0), height, 0.0, 0.0) @ camera_in_body(CAMERA)
        flat = [np.full((60, 80, 3), value, np.float32) for value in (coarse, detail)]
        depth = np.full((60, 80), hidden_by or height, np.float32)
        paint(*flat, depth, transform, (FOCAL, CX, CY), 0.0, 4.0, 0.02, 0.1, best, weight, shade, fine)
    return shade / np.maximum(weight, 1e-12)[:, :, None], fine


def test_detail_is_that_of_the_nearest_picture_and_shade_the_mean():
    shade, fine = painted([(1.0, 100, 20), (2.0, 40, 5), (0.8, 160, 12)])
    assert fine[20, 20, 0] == 12  # 0.8 m away beats 1 m and 2 m
    # From 0.8 m up the picture reaches 1.04 m to the front (60 rows of 80 columns, 120 degrees), from 2 m 2.6 m.
    assert fine[20, 38, 0] == 5
    assert shade[20, 38, 0] == pytest.approx(40)
    weights = np.array([1.0, 2.0, 0.8]) ** -4.0
    assert shade[20, 20, 0] == pytest.approx(weights @ [100, 40, 160] / weights.sum(), rel=0.01)


def test_nothing_is_painted_through_what_stands_before_the_floor():
    shade, fine = painted([(1.0, 100, 20)], hidden_by=0.4)
    assert not shade.any()
    assert not fine.any()
