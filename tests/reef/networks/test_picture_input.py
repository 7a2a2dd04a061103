import numpy as np
import pytest

from coral.reef.networks.picture_input import BYTES, IMAGENET, UNIT, PictureInput


def test_values_by_hand():
    rgb = np.array([[[255, 51, 0]]], np.uint8)
    assert UNIT.tensor(rgb).ravel().tolist() == pytest.approx([1.0, 0.2, 0.0])
    assert BYTES.tensor(rgb).ravel().tolist() == [255.0, 51.0, 0.0]
    assert IMAGENET.tensor(rgb).ravel()[0] == pytest.approx((1.0 - 0.485) / 0.229)
    assert PictureInput("0 to 1", bgr=True).tensor(rgb).ravel().tolist() == pytest.approx([0.0, 0.2, 1.0])
    assert UNIT.tensor(rgb).shape == (1, 3, 1, 1)
