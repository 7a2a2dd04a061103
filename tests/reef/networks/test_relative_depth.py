import cv2
import numpy as np
import pytest
from given_eyes import FlatEyes

from coral.errors import InputError
from coral.onnx_file import OnnxFile, open_onnx, open_picture_network
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.networks.relative_depth import DepthAnything, RelativeDepthEyes, fit_scale_shift
from coral.reef.vehicle.camera import CameraCfg
from onnx_files import relative_depth


def test_scale_and_shift_come_back_from_sparse_points_with_outliers():
    rng = np.random.default_rng(3)
    depth = rng.uniform(0.5, 8.0, 60).astype(np.float32)
    relative = ((1.0 / depth - 0.05) / 0.25).astype(np.float32)
    depth[:9] *= 3.0  # echoes of something else
    fit = fit_scale_shift(relative, depth)
    assert fit.scale == pytest.approx(0.25, rel=1e-2)
    assert fit.shift == pytest.approx(0.05, abs=2e-3)
    np.testing.assert_allclose(fit.metres(relative[9:]), depth[9:], rtol=0.02)


def test_the_known_height_is_enough_where_the_sea_floor_shows():
    camera = CameraCfg(width=32, height=24)
    true = ground_depth(camera, 0.7)
    relative = np.where(np.isfinite(true), 4.0 / true - 1.0, 0.0).astype(np.float32)
    near = true < 8.0
    np.testing.assert_allclose(fit_scale_shift(relative[near], true[near]).metres(relative)[-1], true[-1], rtol=1e-3)


@pytest.mark.parametrize(
    ("relative", "depth"),
    [([1.0], [1.0]), ([1.0, 1.0], [1.0, 2.0]), ([1.0, 2.0], [1.0, 2.0]), ([1.0, 2.0], [np.inf, 1.0])],
)
def test_points_that_say_nothing_are_refused(relative, depth):
    with pytest.raises(ValueError, match=r"scale and shift|nearer"):
        fit_scale_shift(np.array(relative, np.float32), np.array(depth, np.float32))


class Session:
    def run(self, names, feeds):
        return [feeds["pixel_values"][:, 0]]  # the normalised red channel, as a relative depth


def fake(inputs=None, outputs=None):
    return OnnxFile(
        "d.onnx",
        Session(),
        inputs or {"pixel_values": (1, 3, 28, 42)},
        outputs or {"predicted_depth": (1, 28, 42)},
        {},
    )


def test_pictures_are_normalised_and_results_have_the_cameras_size():
    rgb = np.full((12, 16, 3), 255, np.uint8)
    relative = DepthAnything(fake()).relative(rgb, CameraCfg(width=16, height=12))
    np.testing.assert_allclose(relative, (1 - 0.485) / 0.229, rtol=1e-5)
    assert relative.shape == (12, 16)


GROUND = cv2.resize(np.minimum(ground_depth(CameraCfg()), 20.0), (28, 28), interpolation=cv2.INTER_AREA)


@pytest.mark.parametrize("names", [("pixel_values", "predicted_depth"), ("image", "depth"), ("l_x_", "select_36")])
@pytest.mark.parametrize("channel", [False, True])
@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("kind", ["relative", "metric"])
def test_exports_of_depth_anything_show_the_same(monkeypatch, tmp_path, names, channel, free, half, kind):
    """Names, with or without an axis for the one channel, fixed or free size, single or half precision."""
    pytest.importorskip("onnxruntime")
    path = tmp_path / "d.onnx"
    values = 1.0 / GROUND if kind == "relative" else GROUND
    path.write_bytes(relative_depth(values, names, channel, free, half=half))
    monkeypatch.setattr("coral.reef.networks.relative_depth.SIZE", (28, 28))
    network = DepthAnything(open_picture_network(path))
    assert network.metric == (kind == "metric")
    assert f"{kind} as the shipped picture shows" in network.about[0]
    found = network.relative(np.zeros((28, 28, 3), np.uint8), CameraCfg(width=28, height=28))
    np.testing.assert_allclose(found, 1.0 / GROUND, rtol=5e-3)


def test_what_is_stated_must_be_so(tmp_path):
    pytest.importorskip("onnxruntime")
    path = tmp_path / "d.onnx"
    path.write_bytes(relative_depth(GROUND))
    (tmp_path / "d.eyes.yaml").write_text("depth: relative")
    with pytest.raises(InputError, match="stated as relative, expected metric, as the shipped picture shows"):
        DepthAnything(open_picture_network(path))


@pytest.mark.parametrize(
    "wrong",
    [
        {"outputs": {"y": (1,)}},
        {"outputs": {"a": (1, 28, 42), "b": (1, 28, 42)}},
        {"outputs": {"boxes": (1, 84, 8400)}},
        {"inputs": {"pixel_values": (1, 4, 28, 42)}},
    ],
)
def test_another_layout_is_one_clear_line(wrong):
    with pytest.raises(InputError, match=r"d\.onnx: inputs, outputs: found .* one map of depth"):
        DepthAnything(fake(**wrong))


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
