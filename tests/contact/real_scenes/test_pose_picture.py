import numpy as np
from painted_table import BOX, at, picture

from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.pose_picture import draw_poses

GREEN = [60, 230, 60]


def green(canvas):
    return (canvas == GREEN).all(axis=2)


def test_the_outline_lies_on_the_object():
    frame, (truth,) = picture(at(0.0, 0.0))
    canvas = draw_poses(frame, {"box": BOX}, {"box": PoseEstimate(at(0.0, 0.0), 1.0)})
    assert canvas.shape == (720, 960, 3)
    rows, columns = np.nonzero(green(canvas))
    inside_rows, inside_columns = np.nonzero(truth)
    assert abs(rows.min() / 10 - inside_rows.min()) <= 1
    assert abs(columns.max() / 10 - inside_columns.max()) <= 2


def test_a_lost_object_is_not_drawn_and_without_colours_all_else_is_black():
    frame, _ = picture(at(0.0, 0.0), colours=False)
    lost = {"box": PoseEstimate(at(0.0, 0.0), 0.0, lost=True)}
    assert not draw_poses(frame, {"box": BOX}, lost).any()
