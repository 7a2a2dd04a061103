import numpy as np
import pytest
from given_networks import given

from coral.errors import InputError
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.yolo_eyes import YoloEyes, class_labels, is_yolo
from coral.reef.eyes.yolo_masks import PROTOTYPES
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


def test_names_say_what_classes_are():
    assert class_labels("{0: 'Rock', 1: 'live oyster', 2: 'sand'}", 3, "f") == {0: Label.OBSTACLE, 1: Label.OYSTER}
    assert class_labels(None, 2, "f") == {0: Label.OYSTER, 1: Label.OBSTACLE}


@pytest.mark.parametrize("names", ["{0: 'fish'}", "oyster", "[1, 2]", "{" * 500])
def test_names_without_an_oyster_are_one_clear_line(names):
    with pytest.raises(InputError, match=r"f: metadata\.names: found"):
        class_labels(names, 1, "f")
