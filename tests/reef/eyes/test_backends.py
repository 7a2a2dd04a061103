import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.vehicle.camera import CameraCfg


def test_exact_perception_needs_no_eyes():
    assert open_eyes("exact") is None


def test_another_word_suggests_the_nearest():
    with pytest.raises(
        InputError, match=r"--perception: found 'rbg', expected exact, painted, rgb or FILE.onnx \(did you mean"
    ):
        open_eyes("rbg")


@pytest.mark.parametrize("name", ["painted", "rgb"])
def test_a_shipped_network_sees_the_same_twice(name):
    pytest.importorskip("onnxruntime")
    eyes = open_eyes(name)
    rgb = np.random.default_rng(0).integers(0, 255, (120, 160, 3), np.uint8)
    first, again = (eyes.perceive(rgb, CameraCfg(), CameraAttitude()) for _ in range(2))
    assert first.labels.shape == first.depth.shape == first.doubt.shape == (120, 160)
    assert ((first.doubt >= 0.0) & (first.doubt <= 1.0)).all()
    assert np.array_equal(first.depth, again.depth)


def test_the_network_for_real_pictures_is_not_for_painted_ones():
    with pytest.raises(InputError, match=r"--perception: found rgb, for real pictures, expected painted"):
        open_eyes("rgb", painted=True)
