import dataclasses

import numpy as np
import pytest

from coral.reef.pictures.cameraview import DEPTH_MAX_M, LABEL_COLORS, camera_picture, depth_levels
from coral.reef.world.geometry import Frame


def test_camera_pictures_show_classes_and_distance():
    labels = np.repeat(np.arange(4, dtype=np.uint8), 40)[None].repeat(120, axis=0)
    depth = np.full((120, 160), 2.0, np.float32)
    depth[:, 80:] = 6.0
    depth[:20] = np.inf
    frame = Frame(depth, labels, np.full((120, 160), -1, np.int32))
    seen = camera_picture(frame)
    assert seen.shape == (480, 640, 3)
    water, oyster, rock, seabed = (seen[240, x].astype(int) for x in (80, 240, 400, 560))
    assert water[2] > water[0]
    assert oyster[1] > 2 * oyster[0]
    assert rock.max() < 60
    assert np.ptp(seabed) < 25
    far = camera_picture(frame, "depth")
    assert far[200, 100].sum() > far[200, 500].sum() > far[10, 100].sum()


def test_far_and_near_are_clipped_and_nothing_seen_has_a_level_of_its_own():
    depth = np.array([[0.0, np.inf, np.nan, 1e-3, DEPTH_MAX_M / 2, DEPTH_MAX_M, 100.0]], np.float32)
    assert depth_levels(depth).tolist() == [[255, 255, 255, 0, 127, 254, 254]]


@pytest.mark.parametrize("kind", ["segmentation", "depth"])
def test_a_picture_has_the_size_that_was_asked_for(kind):
    frame = Frame(np.ones((12, 16), np.float32), np.zeros((12, 16), np.uint8), np.zeros((12, 16), np.int32))
    assert camera_picture(frame, kind, (320, 240)).shape == (240, 320, 3)


def coloured():
    rgb = np.zeros((12, 16, 3), np.uint8)
    rgb[:, :8] = (200, 40, 0)
    return Frame(np.ones((12, 16), np.float32), np.ones((12, 16), np.uint8), np.zeros((12, 16), np.int32), rgb)


def test_the_colour_picture_is_what_the_camera_took():
    assert camera_picture(coloured(), "colour", (64, 48))[24, 10].tolist() == [200, 40, 0]
    with pytest.raises(ValueError, match="no colour picture"):
        camera_picture(dataclasses.replace(coloured(), rgb=None), "colour")


def test_classes_are_drawn_over_the_colours():
    seen = camera_picture(coloured(), "segmentation", (64, 48)).astype(int)
    left, right = seen[24, 10], seen[24, 54]
    assert (left == (LABEL_COLORS[1].astype(int) + (200, 40, 0) + 1) // 2).all()
    assert right[1] > right[0]
