import numpy as np

from coral.reef.paint.collage import OTHER
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.teaching import draw_collages, draw_titles, gather_real, paint_reefs


def test_painted_reefs_are_compact_and_agree_in_shape():
    reefs = paint_reefs(3, 1, 2, (32, 24))
    assert reefs.rgb.shape == (2, 24, 32, 3)
    assert reefs.floor.shape == reefs.labels.shape == reefs.depth.shape == (2, 24, 32)
    assert reefs.rgb.std() > 1.0


def test_collages_and_real_pictures_have_their_share_of_a_batch():
    clumps, bare = draw_collages(0, 2, (64, 48)), draw_collages(0, 2, (64, 48), bare=True)
    assert clumps.rgb.shape == bare.rgb.shape == (2, 48, 64, 3)
    assert (bare.target == OTHER).all()
    one = LabelledPicture("a-1", np.zeros((30, 50, 3), np.uint8), np.full((30, 50), OTHER, np.uint8))
    real = gather_real([one, one])
    assert real.rgb.shape[:3] == real.target.shape
    assert 0.5 < clumps.share + bare.share + real.share < 1.0
    assert len(gather_real([]).rgb) == 0


def test_titles_are_letters_in_boxes():
    titles = draw_titles(0, 3, (160, 120))
    assert titles.shape == (3, 2, 120, 160)
    assert all(one.any() for one in titles.reshape(6, -1))
