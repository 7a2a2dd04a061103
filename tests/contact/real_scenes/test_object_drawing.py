import numpy as np
import pytest
from solid_object import solid

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.object_drawing import draw_depth
from coral.contact.scene.geometry import pose_matrix


def test_a_box_is_drawn_where_it_is():
    box = solid(("box", (0.05, 0.05, 0.05)))
    nothing, lens = np.zeros((48, 64), np.float32), np.array([100.0, 100.0, 31.5, 23.5])
    frame = RgbdFrame(nothing, nothing.astype(np.uint8), (), lens, np.eye(4))
    depth = draw_depth(box.solids, pose_matrix(np.eye(3), [0.0, 0.0, 1.0]), frame)
    assert depth[24, 32] == pytest.approx(0.95)
    assert np.isinf(depth[0, 0])
    rows, columns = np.nonzero(np.isfinite(depth))
    assert (rows.max() - rows.min(), columns.max() - columns.min()) == (9, 9)  # 0.1 m at 0.95 m
