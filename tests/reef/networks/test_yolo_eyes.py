import numpy as np
import pytest
from given_networks import given

from coral.errors import InputError
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.networks.yolo_eyes import (
    GRAY,
    PROTOTYPES,
    Letterbox,
    YoloEyes,
    decode,
    draw_masks,
    is_yolo,
    layout_of,
)
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


def test_a_wide_picture_gets_borders_above_and_below():
    box = Letterbox(width=160, height=120, net_width=64, net_height=64)
    assert (box.inner, box.corner) == ((64, 48), (0, 8))
    out = box.insert(np.full((120, 160, 3), 7, np.uint8))
    assert (out[:8] == GRAY).all()
    assert (out[8:56] == 7).all()
    assert (out[56:] == GRAY).all()


def test_a_map_comes_back_to_the_pixels_it_was_made_from():
    box = Letterbox(width=40, height=20, net_width=80, net_height=80)
    coarse = np.zeros((40, 40), np.float32)  # half the size of the network's picture
    coarse[10:30, 20:] = 1.0  # the right half of the picture
    back = box.extract(coarse)
    assert back.shape == (20, 40)
    assert (back[:, :19] == 0.0).all()
    assert (back[:, 21:] == 1.0).all()


def candidates(*rows):
    """Raw outputs of a network with two classes from (box, scores, weight of the first prototype)."""
    raw = np.zeros((4 + 2 + PROTOTYPES, len(rows)), np.float32)
    for k, (box, scores, weight) in enumerate(rows):
        raw[:4, k], raw[4:6, k], raw[6, k] = box, scores, weight
    return raw, "classes"


def test_boxes_are_corners_and_the_likeliest_comes_first():
    found = decode(*candidates(((10, 20, 4, 8), (0.1, 0.6), 1), ((50, 50, 2, 2), (0.9, 0.2), 1)))
    assert found.classes.tolist() == [0, 1]
    assert found.boxes.tolist() == [[49, 49, 51, 51], [8, 16, 12, 24]]


def test_weak_candidates_and_doubles_of_a_class_are_left_out():
    box = (10, 10, 8, 8)
    found = decode(*candidates((box, (0.9, 0), 1), (box, (0.8, 0), 1), (box, (0, 0.7), 1), (box, (0.1, 0.1), 1)))
    np.testing.assert_allclose(found.scores, [0.9, 0.7])


def test_a_mask_is_the_weighted_prototype_within_the_box():
    found = decode(*candidates(((8, 4, 16, 8), (0.9, 0), 2.0)))  # the upper half of a picture of 16 x 16
    prototypes = np.zeros((PROTOTYPES, 4, 4), np.float32)
    prototypes[0, :, :2] = 3.0
    masks = draw_masks(found, prototypes, (16, 16))
    assert masks.shape == (1, 4, 4)
    assert masks[0, 0, 0] == pytest.approx(1 / (1 + np.exp(-6.0)))
    assert masks[0, 0, 3] == 0.5
    assert (masks[0, 2:] == 0.0).all()


def test_no_object_at_all():
    found = decode(*candidates(((1, 1, 1, 1), (0.0, 0.1), 1)))
    assert draw_masks(found, np.zeros((PROTOTYPES, 4, 4), np.float32), (16, 16)).shape == (0, 4, 4)


@pytest.mark.parametrize(
    ("shape", "classes", "size", "layout"),
    [
        ((37, 8400), 1, (640, 640), "classes"),
        ((37, 8400), 2, (640, 640), None),
        ((25200, 39), 2, (640, 640), "objectness"),
        ((25200, 38), 1, (640, 640), "objectness"),
        ((567, 38), 1, (96, 96), "objectness"),
        ((300, 38), 1, (96, 96), "chosen"),
        ((300, 38), 7, (640, 640), "chosen"),
        ((300, 6), 1, (640, 640), None),
    ],
)
def test_a_layout_is_told_by_shape_and_classes_together(shape, classes, size, layout):
    assert layout_of(*shape, classes, size) == layout
