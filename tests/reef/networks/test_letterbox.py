import numpy as np

from coral.reef.networks.letterbox import GRAY, Letterbox


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
