from pathlib import Path

import cv2
import numpy as np
import pytest
from given_networks import given, one_hot

from coral.errors import InputError
from coral.reef.eyes.backends import PaintedOnlyEyes, open_eyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import ReefNetEyes
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


LABELS = [[0, 2, 1, 3], [3, 2, 3, 3]]


def outputs():
    flat = np.full((1, 1, 2, 4), 2.0, np.float32)
    return {"logits": one_hot(LABELS), "depth": flat, "depth_doubt": flat * 0.1}


@pytest.mark.parametrize(("from_real", "from_painted", "judged"), [(1.0, 0.9, True), (0.4, 0.9, False)])
def test_eyes_for_painted_pictures_ask_the_other_network_whether_one_is_painted(from_real, from_painted, judged):
    real = given({**outputs(), "unlike": np.array([[from_real, from_painted]], np.float32)}, channels=4)
    eyes = PaintedOnlyEyes(ReefNetEyes(given(outputs(), channels=4)), ReefNetEyes(real))
    seen = eyes.perceive(np.zeros((2, 4, 3), np.uint8), CameraCfg(width=4, height=2), CameraAttitude())
    assert (seen.unlike < 1.0) is judged
    assert seen.labels.tolist() == LABELS


def test_a_painted_picture_is_familiar_to_the_network_for_painted_ones():
    pytest.importorskip("onnxruntime")
    own_network = pytest.importorskip("coral.reef.networks.own_network")  # a wing: it has a painted picture
    path = Path(own_network.__file__).parent / "check_picture/rgb.jpg"
    rgb = np.ascontiguousarray(cv2.imread(str(path))[..., ::-1])
    camera = CameraCfg(width=rgb.shape[1], height=rgb.shape[0])
    asked, sure = open_eyes("painted"), open_eyes("painted", painted=True)
    seen, same = (eyes.perceive(rgb, camera, CameraAttitude()) for eyes in (asked, sure))
    assert 0.0 < seen.unlike < 0.9
    assert same.unlike == 0.0  # the simulator does not ask
    np.testing.assert_array_equal(seen.labels, same.labels)
