import cv2
import numpy as np
import pytest

from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.perception.scene_labels import PictureLabels, label_picture, pixel_of, place_names, zoomed

LENS = np.array([300.0, 300.0, 160.0, 120.0])


def frame():
    rgb = np.full((240, 320, 3), 128, np.uint8)
    pose = look_at((-0.8, 0.0, 0.5), (0.0, 0.0, 0.0))
    flat = np.zeros((240, 320))
    return RgbdFrame(flat.astype(np.float32), flat.astype(np.uint8), (), LENS, pose, rgb=rgb)


def labels(**objects):
    return PictureLabels(objects, {}, {}, np.array([0.0, 0.0, 0.3]))


def decoded(picture):
    return cv2.imdecode(np.frombuffer(picture.png, np.uint8), cv2.IMREAD_COLOR)


def test_the_target_of_the_camera_is_in_the_middle_and_left_is_left():
    assert pixel_of(frame(), np.zeros(3)) == (160, 120)
    column, row = pixel_of(frame(), np.array([0.0, 0.1, 0.0]))
    assert column < 160
    assert row == pytest.approx(120, abs=1)


def test_what_is_behind_the_camera_has_no_pixel():
    assert pixel_of(frame(), np.array([-2.0, 0.0, 0.5])) is None
    assert label_picture(frame(), labels(far=np.array([-2.0, 0.0, 0.5]))).png


def shown(**objects):
    """The frame as `label_picture` cuts it."""
    axes = [np.zeros(3), *(0.1 * np.eye(3))]
    return zoomed(frame(), [*axes, np.array([0.0, 0.0, 0.3]), *objects.values()])


def test_a_name_is_drawn_where_its_object_is_believed_to_be():
    place = np.array([0.0, 0.05, 0.1])
    with_box, without = decoded(label_picture(frame(), labels(box=place))), decoded(label_picture(frame(), labels()))
    changed = np.argwhere((with_box != without).any(axis=2))
    column, row = pixel_of(shown(box=place), place)
    assert np.abs(changed.mean(axis=0) - [row, column]).max() < 16


def test_the_y_axis_is_drawn_in_green_to_the_left():
    picture = decoded(label_picture(frame(), labels()))
    begin, end = pixel_of(shown(), np.zeros(3)), pixel_of(shown(), np.array([0.0, 0.1, 0.0]))
    blue, green, red = picture[begin[1], (begin[0] + end[0]) // 2]
    assert green > 150 > 100 > max(red, blue)
    assert end[0] < begin[0]


def test_names_of_things_at_one_place_cover_neither_each_other_nor_the_place():
    boxes = place_names([((60, 16), (100, 100))] * 9, 320, 240)
    for k, (left, top, right, bottom) in enumerate(boxes):
        assert 0 <= left < right <= 320
        assert 0 <= top < bottom <= 240
        assert not (left <= 100 <= right and top <= 100 <= bottom)
        assert all(left >= o[2] or right <= o[0] or top >= o[3] or bottom <= o[1] for o in boxes[:k])


def test_a_name_in_a_corner_stays_in_the_picture():
    ((left, top, right, bottom),) = place_names([((60, 16), (318, 239))], 320, 240)
    assert right <= 320
    assert bottom <= 240
    assert min(left, top) >= 0


def test_the_part_with_the_scene_is_enlarged_and_its_pixels_still_show_the_same_points():
    coloured = frame()
    at = np.array([0.02, 0.03, 0.0])
    column, row = pixel_of(coloured, at)
    coloured.rgb[row - 1 : row + 2, column - 1 : column + 2] = 255
    near = zoomed(coloured, [at, np.array([0.0, 0.1, 0.0])])
    assert near.rgb.shape == coloured.rgb.shape == (*near.depth.shape, 3)
    assert near.lens[0] > 2 * coloured.lens[0]
    column, row = pixel_of(near, at)
    assert near.rgb[row, column].min() > 250


def test_a_frame_with_points_all_over_it_or_none_stays_as_it_is():
    whole = frame()
    assert zoomed(whole, []) is whole
    assert zoomed(whole, [np.array([0.0, side, 0.0]) for side in (-0.45, 0.45)]) is whole
