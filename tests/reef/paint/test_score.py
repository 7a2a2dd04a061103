import numpy as np

from coral.reef.eyes.perception import SeenPicture
from coral.reef.paint.collage import OTHER
from coral.reef.paint.labelled_pictures import UNKNOWN, LabelledPicture
from coral.reef.paint.score import EyesScore, video_rows
from coral.reef.world.geometry import Frame, Label


def test_overlap_recall_and_depth_error_by_range_of_the_truth():
    truth = Frame(
        np.array([[0.5, 0.5, 1.5, 2.5]], np.float32), np.array([[1, 1, 3, 2]], np.uint8), np.full((1, 4), -1, np.int32)
    )
    seen = SeenPicture(
        np.array([[1, 3, 1, 2]], np.uint8), np.array([[0.5, 0.55, 1.5, 3.0]], np.float32), np.zeros((1, 4), np.float32)
    )
    score = EyesScore()
    score.add(seen, truth, np.ones((1, 4), np.float32))
    assert score.overlap(Label.OYSTER)[:3] == [0.5, 0.0, None]
    assert score.overlap(Label.OYSTER, 3.0) == [0.333]
    assert score.recall(Label.OBSTACLE)[2] == 1.0
    assert score.depth_error()[:3] == [0.05, 0.0, 0.2]


def test_depth_that_is_not_seen_has_no_error():
    truth = Frame(np.ones((1, 1), np.float32), np.ones((1, 1), np.uint8), np.full((1, 1), -1, np.int32))
    score = EyesScore()
    score.add(
        SeenPicture(np.zeros((1, 1), np.uint8), np.full((1, 1), np.inf, np.float32), np.zeros((1, 1), np.float32)),
        truth,
        np.ones((1, 1), np.float32),
    )
    assert score.depth_error() == [None] * 5
    assert score.recall(Label.OYSTER)[1] == 0.0


def test_the_doubt_of_the_floor_is_that_of_what_is_floor_and_seen_as_such():
    truth = Frame(np.full((1, 4), 1.5, np.float32), np.array([[3, 3, 1, 3]], np.uint8), np.full((1, 4), -1, np.int32))
    seen = SeenPicture(np.array([[3, 3, 3, 0]], np.uint8), truth.depth, np.array([[0.1, 0.3, 0.9, 0.9]], np.float32))
    score = EyesScore()
    score.add(seen, truth, np.ones((1, 4), np.float32))
    assert score.floor_doubt() == [None, 0.2, None, None, None]


def test_a_box_counts_whole_and_between_points_nothing_counts():
    target = np.full((4, 8), UNKNOWN, np.uint8)
    target[0, :2], target[1, :2] = int(Label.OYSTER), OTHER
    said = np.zeros((4, 8), bool)
    said[:, :4] = True
    rgb = np.zeros((4, 8, 3), np.uint8)
    ((points,), (box,)) = (
        video_rows([(LabelledPicture("v-1", rgb, target, of_points=of_points), said, said)])
        for of_points in (True, False)
    )
    assert (points["iou"], points["recall"], points["true"]) == (0.5, 1.0, 0.5)
    assert (box["precision"], box["true"]) == (0.875, 0.938)
