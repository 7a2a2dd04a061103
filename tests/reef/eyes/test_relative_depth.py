import numpy as np
import pytest

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.relative_depth import DepthAnything, fit_scale_shift, floor_points
from coral.reef.vehicle.camera import CameraCfg


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
    points = floor_points(relative, np.isfinite(true) & (true < 8.0), true)
    np.testing.assert_allclose(fit_scale_shift(*points).metres(relative)[-1], true[-1], rtol=1e-3)


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


def test_another_layout_is_one_clear_line():
    with pytest.raises(InputError, match=r"d\.onnx: outputs: found y, expected predicted_depth"):
        DepthAnything(fake(outputs={"y": (1,)}))
    with pytest.raises(InputError, match="multiples of 14"):
        DepthAnything(fake(inputs={"pixel_values": (1, 3, 30, 42)}))
