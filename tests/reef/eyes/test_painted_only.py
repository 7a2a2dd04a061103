"""Eyes for painted pictures know one that is none."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from given_networks import given, one_hot

from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.painted_only import PaintedOnlyEyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import ReefNetEyes
from coral.reef.vehicle.camera import CameraCfg

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
