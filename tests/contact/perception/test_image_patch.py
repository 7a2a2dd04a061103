"""Patches of pictures: distance to the mask, what hides the object, the lens of a coarser patch."""

import numpy as np
import pytest
from drawn_object import LENS

from coral.contact.perception.image_patch import OCCLUDED_RIM, ROBOT, box_of, crop_patch, project


def test_the_distance_to_the_mask_is_signed():
    mask = np.zeros((20, 30), bool)
    mask[5:12, 8:20] = True
    robot = np.zeros_like(mask)
    robot[5:12, 20:24] = True
    v = crop_patch(np.ones((20, 30), np.float32), mask, robot, LENS, (0, 30, 0, 20), 10**6)
    assert v.mask_distance[8, 5] == pytest.approx(3.0, abs=0.1)
    assert v.mask_distance[8, 8] == 0.0
    assert v.mask_distance[8, 11] == pytest.approx(-3.0, abs=0.1)
    assert (v.occlusion[5:12, 20:24] == ROBOT).all()
    assert v.occlusion[8, 19] == OCCLUDED_RIM
    assert v.occlusion[8, 8] == 0


def test_a_coarse_patch_has_its_own_lens():
    mask = np.zeros((120, 160), bool)
    mask[40:80, 40:120] = True
    v = crop_patch(np.ones((120, 160), np.float32), mask, ~mask, LENS, (30, 130, 30, 90), 1500)
    assert v.mask.size <= 1500
    step = LENS[0] / v.lens[0]
    assert v.lens[2] * step + 30 == pytest.approx(LENS[2])


def test_the_box_of_a_mask_holds_points_too_and_stays_in_the_picture():
    mask = np.zeros((20, 30), bool)
    mask[5:12, 8:20] = True
    assert box_of(mask, 2) == (6, 22, 3, 14)
    assert box_of(mask, 2, np.array([[25.4, 1.5], [100.0, 6.0]])) == (6, 30, 0, 14)


def test_points_behind_the_camera_are_not_projected():
    points = np.array([[0.1, -0.2, 2.0], [0.0, 0.0, -1.0]])
    np.testing.assert_allclose(project(points, LENS), [LENS[2:] + LENS[:2] * [0.05, -0.1]])
