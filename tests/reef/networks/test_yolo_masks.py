import numpy as np
import pytest

from coral.reef.networks.yolo_masks import PROTOTYPES, box_overlap, decode, draw_masks, layout_of


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


def test_overlap_of_boxes_by_hand():
    others = np.array([[0, 0, 2, 2], [1, 0, 3, 2], [5, 5, 6, 6]], np.float32)
    np.testing.assert_allclose(box_overlap(others[0], others), [1.0, 1 / 3, 0.0])


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
