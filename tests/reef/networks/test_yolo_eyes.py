import numpy as np
import pytest
from given_networks import given

from coral.errors import InputError
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.networks.yolo_eyes import YoloEyes, is_yolo
from coral.reef.networks.yolo_masks import PROTOTYPES
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

CAMERA = CameraCfg(width=32, height=16)
NAMES = "{0: 'oyster', 1: 'rock'}"


def network(metadata=None):
    raw = np.zeros((1, 4 + 2 + PROTOTYPES, 2), np.float32)
    raw[0, :4, 0], raw[0, 4, 0], raw[0, 6, 0] = (8, 20, 16, 8), 0.9, 9.0  # an oyster, lower left of 32 x 32
    raw[0, :4, 1], raw[0, 5, 1], raw[0, 6, 1] = (24, 16, 8, 16), 0.8, 9.0  # a rock, right
    prototypes = np.zeros((1, PROTOTYPES, 32, 32), np.float32)
    prototypes[0, 0] = 1.0
    return given({"output0": raw, "output1": prototypes}, size=(32, 32), metadata=metadata)


def test_objects_become_labels_where_the_letterbox_puts_them():
    seen = YoloEyes(network({"names": NAMES})).perceive(np.zeros((16, 32, 3), np.uint8), CAMERA, CameraAttitude())
    assert (seen.labels[9:15, 1:15] == Label.OYSTER).all()
    assert (seen.labels[1:15, 21:27] == Label.OBSTACLE).all()
    assert (seen.labels[15, 17:19] == Label.SEABED).all()
    assert (seen.labels[0, :19] == Label.WATER).all()
    assert np.isfinite(seen.depth[10, 5])
    assert seen.doubt[10, 5] == pytest.approx(0.1)


def test_two_outputs_with_prototypes_are_yolo():
    assert is_yolo(network())
    assert not is_yolo(given({"logits": np.zeros((1, 4, 2, 4), np.float32)}))


def test_names_that_contradict_the_outputs_are_refused():
    with pytest.raises(InputError, match=r"outputs: found 1 x 38 x 2 for 3 classes"):
        YoloEyes(network({"names": "{0: 'oyster', 1: 'rock', 2: 'crab'}"}))


def test_an_object_of_a_class_without_a_name_is_refused():
    raw = np.zeros((1, 2, 6 + PROTOTYPES), np.float32)
    raw[0, 0, :6] = 0, 0, 8, 8, 0.9, 7
    file = given({"o": raw, "p": np.zeros((1, PROTOTYPES, 32, 32), np.float32)}, (32, 32), metadata={"names": NAMES})
    with pytest.raises(InputError, match="found an object of class 7, expected one of the 2 classes that have names"):
        YoloEyes(file).perceive(np.zeros((16, 32, 3), np.uint8), CAMERA, CameraAttitude())
