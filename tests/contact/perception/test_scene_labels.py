import cv2
import numpy as np
import pytest

from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.perception.scene_labels import PictureLabels, label_picture, pixel_of

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


def test_a_name_is_drawn_where_its_object_is_believed_to_be():
    place = np.array([0.0, 0.2, 0.0])
    with_box, without = decoded(label_picture(frame(), labels(box=place))), decoded(label_picture(frame(), labels()))
    changed = np.argwhere((with_box != without).any(axis=2))
    column, row = pixel_of(frame(), place)
    assert np.abs(changed.mean(axis=0) - [row, column]).max() < 12


def test_the_y_axis_is_drawn_in_green_to_the_left():
    picture = decoded(label_picture(frame(), labels()))
    begin, end = pixel_of(frame(), np.zeros(3)), pixel_of(frame(), np.array([0.0, 0.1, 0.0]))
    blue, green, red = picture[begin[1], (begin[0] + end[0]) // 2]
    assert green > 150 > 100 > max(red, blue)
    assert end[0] < begin[0]
