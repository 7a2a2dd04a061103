import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import SHIPPED
from coral.reef.eyes.relative_depth_eyes import RelativeDepthEyes
from coral.reef.vehicle.camera import CameraCfg
from onnx_files import relative_depth


def test_exact_perception_needs_no_eyes():
    assert open_eyes("exact") is None


def test_another_word_suggests_the_nearest():
    with pytest.raises(InputError, match=r"--perception: found 'rbg', expected exact, rgb or FILE.onnx \(did you mean"):
        open_eyes("rbg")


def test_the_shipped_network_sees_the_same_twice():
    pytest.importorskip("onnxruntime")
    eyes = open_eyes("rgb")
    rgb = np.random.default_rng(0).integers(0, 255, (120, 160, 3), np.uint8)
    first, again = (eyes.perceive(rgb, CameraCfg(), CameraAttitude()) for _ in range(2))
    assert first.labels.shape == first.depth.shape == first.doubt.shape == (120, 160)
    assert ((first.doubt >= 0.0) & (first.doubt <= 1.0)).all()
    assert np.array_equal(first.depth, again.depth)


def test_a_depth_network_needs_classes_from_elsewhere(tmp_path):
    pytest.importorskip("onnxruntime")
    path = tmp_path / "d.onnx"
    path.write_bytes(relative_depth(np.ones((14, 28))))
    with pytest.raises(InputError, match=r"d\.onnx: outputs: found predicted_depth alone, expected classes.*--depth"):
        open_eyes(str(path))
    with pytest.raises(InputError, match=r"--depth: found .*d\.onnx beside exact, expected --perception rgb"):
        open_eyes("exact", depth=str(path))
    with pytest.raises(InputError, match="found picture, expected pixel_values"):
        open_eyes("rgb", depth=str(SHIPPED))
    assert isinstance(open_eyes("rgb", depth=str(path)), RelativeDepthEyes)
