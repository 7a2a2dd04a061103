import numpy as np

from coral.reef.paint.training_set import hide_beyond, make_samples
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label


def test_samples_are_the_same_for_the_same_seed_and_labels_agree_with_depth():
    first, again = (list(make_samples(7, 1, 2, (32, 16))) for _ in range(2))
    for a, b in zip(first, again, strict=True):
        assert np.array_equal(a.picture, b.picture)
        assert a.picture.shape == (4, 16, 32)
        assert np.array_equal(np.isinf(a.depth), a.labels == Label.WATER)
    assert not np.array_equal(first[0].picture, first[1].picture)


def test_what_the_water_hides_is_water():
    camera = CameraCfg(width=3, height=3, hfov_deg=90.0)
    frame = Frame(np.full((3, 3), 2.0, np.float32), np.full((3, 3), 3, np.uint8), np.full((3, 3), -1, np.int32))
    labels, depth = hide_beyond(frame, camera, 2.1)
    assert labels.tolist() == [[0, 0, 0], [0, 3, 0], [0, 0, 0]]
    assert np.isinf(depth[0, 0])
    assert depth[1, 1] == 2.0
