import numpy as np

from coral.reef.paint.collage import OTHER
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.teaching import draw_collages, draw_titles, gather_real, hide_beyond, paint_reefs
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label


def test_painted_reefs_are_compact_and_agree_in_shape():
    reefs, again = (paint_reefs(3, 1, 2, (32, 24)) for _ in range(2))
    assert np.array_equal(reefs.rgb, again.rgb)
    assert np.array_equal(np.isinf(reefs.depth), reefs.labels == Label.WATER)
    assert reefs.rgb.shape == (2, 24, 32, 3)
    assert reefs.floor.shape == reefs.labels.shape == reefs.depth.shape == (2, 24, 32)
    assert reefs.rgb.std() > 1.0


def test_what_the_water_hides_is_water():
    camera = CameraCfg(width=3, height=3, hfov_deg=90.0)
    frame = Frame(np.full((3, 3), 2.0, np.float32), np.full((3, 3), 3, np.uint8), np.full((3, 3), -1, np.int32))
    labels, depth = hide_beyond(frame, camera, 2.1)
    assert labels.tolist() == [[0, 0, 0], [0, 3, 0], [0, 0, 0]]
    assert np.isinf(depth[0, 0])
    assert depth[1, 1] == 2.0


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
