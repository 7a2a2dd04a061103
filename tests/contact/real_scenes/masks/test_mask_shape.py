import numpy as np
import pytest

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.masks.mask_shape import clean_mask, hue_saturation_value
from coral.errors import InputError


def test_speckles_go_and_large_parts_stay():
    mask = np.zeros((40, 40), bool)
    mask[2:12, 2:12] = mask[2:10, 20:28] = mask[30:33, 30:33] = True  # 100, 64 and 9 pixels
    mask[20, 5] = True
    cleaned = clean_mask(mask)
    assert cleaned[5, 5]
    assert cleaned[5, 24]
    assert not cleaned[20:].any()


def test_an_empty_mask_stays_empty():
    assert not clean_mask(np.zeros((8, 8), bool)).any()


def test_hue_is_in_degrees():
    rgb = np.full((1, 1, 3), (0, 255, 0), np.uint8)
    frame = RgbdFrame(np.ones((1, 1), np.float32), np.zeros((1, 1), np.uint8), (), np.ones(4), np.eye(4), 0.0, rgb)
    assert hue_saturation_value(frame)[0, 0] == pytest.approx([120.0, 1.0, 1.0])


def test_a_picture_without_colours_is_one_line():
    frame = RgbdFrame(np.ones((1, 1), np.float32), np.zeros((1, 1), np.uint8), (), np.ones(4), np.eye(4))
    with pytest.raises(InputError, match="--masks"):
        hue_saturation_value(frame)
