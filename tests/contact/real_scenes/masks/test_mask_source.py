import numpy as np

from coral.contact.real_scenes.masks.mask_source import clean_mask


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
