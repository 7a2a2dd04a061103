import numpy as np
import pytest
from given_eyes import FlatEyes

from coral.onnx_file import open_onnx
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.relative_depth import DepthAnything
from coral.reef.eyes.relative_depth_eyes import RelativeDepthEyes
from coral.reef.vehicle.camera import CameraCfg
from onnx_files import relative_depth

pytest.importorskip("onnxruntime")
CAMERA = CameraCfg(width=42, height=28, pitch_down_deg=40.0)
RGB = np.zeros((28, 42, 3), np.uint8)


def eyes(tmp_path, depth, doubt=0.1):
    """Eyes whose depth network sees some depth, with a scale and shift that nobody knows."""
    (tmp_path / "d.onnx").write_bytes(relative_depth(7.0 / depth - 2.0))
    return RelativeDepthEyes(FlatEyes(doubt), DepthAnything(open_onnx(tmp_path / "d.onnx")))


def with_a_post(height):
    depth = np.minimum(ground_depth(CAMERA, height), 20.0)
    depth[4:20, 10:14] = 1.1
    return depth


def test_the_floor_at_a_known_height_gives_scale_and_shift(tmp_path):
    true = with_a_post(0.9)
    seen = eyes(tmp_path, true).perceive(RGB, CAMERA, CameraAttitude(height=0.9))
    np.testing.assert_allclose(seen.depth[10:], true[10:], rtol=0.02)  # the post too, which no plane would give


def test_echoes_win_over_a_height_that_is_wrong(tmp_path):
    true = with_a_post(0.9)
    at = np.array([[u, v] for u in range(2, 40, 3) for v in range(12, 27, 2)])
    echoes = np.column_stack([at, true[at[:, 1], at[:, 0]]]).astype(np.float32)
    off = eyes(tmp_path, true).perceive(RGB, CAMERA, CameraAttitude(height=1.2)).depth[20, 30]
    near = eyes(tmp_path, true).perceive(RGB, CAMERA, CameraAttitude(height=1.2, echoes=echoes)).depth[20, 30]
    assert off == pytest.approx(true[20, 30] * 1.2 / 0.9, rel=0.05)
    assert abs(near - true[20, 30]) < 0.6 * abs(off - true[20, 30])


def test_without_points_depth_is_that_of_the_other_eyes(tmp_path):
    doubtful = eyes(tmp_path, with_a_post(0.9), doubt=0.9)
    seen = doubtful.perceive(RGB, CAMERA, CameraAttitude(height=0.9))
    np.testing.assert_array_equal(seen.depth, doubtful.eyes.perceive(RGB, CAMERA, CameraAttitude(height=0.9)).depth)
