import numpy as np

from coral.reef.eyes.doubt import DoubtCfg, choose_labels, drop_doubtful, pack_doubt, unpack_doubt
from coral.reef.world.geometry import Frame, Label


def frame(labels, doubt):
    labels = np.array([labels], np.uint8)
    doubt = None if doubt is None else np.array([doubt], np.float32)
    return Frame(np.ones(labels.shape, np.float32), labels, np.full(labels.shape, -1, np.int32), doubt=doubt)


def test_exact_frames_pass_as_they_are():
    exact = frame([1, 2, 3], None)
    assert drop_doubtful(exact, DoubtCfg()) is exact


def test_doubtful_pixels_become_water_by_the_limit_of_their_class():
    kept = drop_doubtful(frame([1, 2, 3, 1], [0.6, 0.6, 0.6, 0.4]), DoubtCfg(oyster=0.5, obstacle=0.7, seabed=0.5))
    assert kept.labels.tolist() == [[Label.WATER, Label.OBSTACLE, Label.WATER, Label.OYSTER]]
    assert np.isinf(kept.depth).tolist() == [[True, False, True, False]]


def test_the_likeliest_class_is_chosen_and_obstacles_early():
    logits = np.log(np.array([[0.1, 0.0001], [0.5, 0.5998], [0.4, 0.3], [0.0001, 0.1]], np.float32))[:, None, :]
    labels, doubt = choose_labels(logits, obstacle_from=0.35)
    assert labels.tolist() == [[Label.OBSTACLE, Label.OYSTER]]
    np.testing.assert_allclose(doubt, [[0.6, 0.4]], atol=1e-3)


def test_an_oyster_may_count_before_it_is_the_likeliest():
    logits = np.log(np.array([[[0.1]], [[0.35]], [[0.1]], [[0.45]]], np.float32))
    labels, doubt = choose_labels(logits, obstacle_from=0.35, oyster_from=0.3)
    assert labels.tolist() == [[Label.OYSTER]]
    np.testing.assert_allclose(doubt, [[0.65]], atol=1e-3)


def test_doubt_is_packed_to_half_a_step():
    packed = pack_doubt(np.array([[0.0, 0.25, 1.0]], np.float32))
    np.testing.assert_array_equal(packed, [[0, 64, 255]])
    np.testing.assert_allclose(unpack_doubt(packed), [[0, 0.25, 1.0]], atol=0.5 / 255)
