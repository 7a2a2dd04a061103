"""The sheet of colour pictures of clusters."""

import numpy as np

from coral.reef.pictures.things import TILE_PX, stretched, things_picture


class Belief:
    pose = (0.0, 0.0, 0.0)
    tracks = ()

    def __init__(self, count):
        class Thing:
            index, x, y = 3, 1.0, 1.0

        class View:
            distance_m = 2.0
            crop = np.full((50, 50, 3), 90, np.uint8)

        class Views:
            def of(self, tracks):
                return [(Thing, View, 1.0)] * count

        self.best_views = Views()


def test_there_is_a_tile_for_each_and_none_without():
    assert things_picture(Belief(0)) is None
    assert things_picture(Belief(3)).shape == (TILE_PX, 3 * TILE_PX, 3)
    assert things_picture(Belief(6)).shape == (2 * TILE_PX, 4 * TILE_PX, 3)


def test_murky_pictures_gain_contrast():
    murky = np.linspace(70, 90, 3 * 400).reshape(20, 20, 3).astype(np.uint8)
    assert np.ptp(stretched(murky)) > 3 * np.ptp(murky)
