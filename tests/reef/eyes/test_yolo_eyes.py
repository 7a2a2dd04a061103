import numpy as np
import pytest
from given_networks import given

from coral.errors import InputError
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.yolo_eyes import YoloEyes, class_labels, is_yolo, read_names
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
    found = class_labels({0: "Rock", 1: "Live_oyster", 2: "sand"}, "f")
    assert found == {0: Label.OBSTACLE, 1: Label.OYSTER}


@pytest.mark.parametrize("name", ["oyster drill", "oyster toadfish", "dead oyster", "water bottle", "sand dollar"])
def test_a_name_counts_as_a_whole(name):
    assert class_labels({0: name, 1: "oyster"}, "f") == {0: Label.OBSTACLE, 1: Label.OYSTER}


@pytest.mark.parametrize("names", ["oyster", "[1, 2]", "{" * 500])
def test_names_that_are_none_are_one_clear_line(names):
    with pytest.raises(InputError, match=r"f: metadata\.names: found"):
        read_names(names, "f")


def test_a_network_without_oysters_is_refused():
    with pytest.raises(InputError, match=r"f: metadata\.names: found fish, expected a class named as one of"):
        class_labels({0: "fish"}, "f")


def rows_of(columns):
    """Return the candidates of `network` in another layout."""
    raw = network().run(None)["output0"][0].T
    corners = np.concatenate([raw[:, :2] - raw[:, 2:4] / 2, raw[:, :2] + raw[:, 2:4] / 2], axis=1)
    scores, kinds = raw[:, 4:6].max(axis=1, keepdims=True), raw[:, 4:6].argmax(axis=1)[:, None]
    rest = raw[:, 6:]
    if columns == "chosen":
        return np.concatenate([corners, scores, kinds, rest], axis=1, dtype=np.float32)
    objectness = np.where(scores > 0, scores, 0.0)
    return np.concatenate(
        [raw[:, :4], objectness, raw[:, 4:6] / np.maximum(scores, 1e-6), rest], axis=1, dtype=np.float32
    )


@pytest.mark.parametrize("layout", ["chosen", "objectness"])
def test_other_layouts_of_the_same_candidates_show_the_same(layout):
    prototypes = np.zeros((1, PROTOTYPES, 32, 32), np.float32)
    prototypes[0, 0] = 1.0
    outputs = {"output0": rows_of(layout)[None], "output1": prototypes}
    eyes = YoloEyes(given(outputs, size=(32, 32), metadata={"names": NAMES}))
    picture = np.zeros((16, 32, 3), np.uint8)
    same = YoloEyes(network({"names": NAMES})).perceive(picture, CAMERA, CameraAttitude())
    seen = eyes.perceive(picture, CAMERA, CameraAttitude())
    assert eyes.layout == layout
    np.testing.assert_array_equal(seen.labels, same.labels)
    np.testing.assert_allclose(seen.doubt, same.doubt, atol=1e-6)


def test_names_that_contradict_the_outputs_are_refused():
    with pytest.raises(InputError, match=r"outputs: found 1 x 38 x 2 for 3 classes"):
        YoloEyes(network({"names": "{0: 'oyster', 1: 'rock', 2: 'crab'}"}))
