import numpy as np
import pytest
from written_facts import brick, written

from coral.contact.rules.scene_reading import Thing, axis_of, disturbance_term, number, vector

DOWN = (0.0, 1.0, 0.0, 0.0)
"""Turned by 180 degrees about x."""
ON_ITS_SIDE = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
"""Turned by 90 degrees about x: the object's y axis points up, its z axis to -y."""


def thing(**item):
    return Thing("brick", written({"brick": brick(**item)}))


def test_the_height_is_the_extent_along_the_upright_axis():
    assert (thing().up, thing().height, thing().lying) == (2, 0.02, [0, 1])
    side = thing(quat=ON_ITS_SIDE)
    assert (side.up, side.up_sign, side.height, side.lying) == (1, 1.0, 0.04, [0, 2])
    assert thing(quat=DOWN).up_sign == -1.0


def test_the_underside_is_that_of_the_box_wherever_its_frame_is():
    assert thing(at=(0.0, 0.0, 0.05)).low == pytest.approx(0.04)
    assert thing(at=(0.0, 0.0, 0.05), middle_m=[0.0, 0.0, 0.03]).low == pytest.approx(0.07)
    assert thing(at=(0.0, 0.0, 0.05), middle_m=[0.0, 0.0, 0.03], quat=DOWN).low == pytest.approx(0.01)


def test_the_face_toward_a_direction_is_a_lying_one():
    side = thing(quat=ON_ITS_SIDE)
    assert side.toward(np.array([1.0, 0.3, 0.0])) == (0, 1.0)
    assert side.toward(np.array([0.3, 1.0, 0.0])) == (2, -1.0)


def test_fingers_close_across_what_is_narrow_enough_narrowest_first():
    assert thing().closings() == [1, 0]
    assert thing(size=(0.1, 0.06, 0.02)).closings() == [1]
    assert thing(size=(0.1, 0.1, 0.02)).closings() == []
    assert thing(size=(0.1, 0.1, 0.02), quat=ON_ITS_SIDE).closings() == [2]


def test_a_face_has_its_centre_and_normal_in_the_frame_of_the_object():
    off = thing(middle_m=[0.01, 0.0, 0.0])
    assert off.face(0, -1.0) == (pytest.approx([-0.02, 0.0, 0.0]), [-1.0, 0.0, 0.0])
    assert off.face(0, 1.0, {1: 0.5, 2: -1.0})[0] == pytest.approx([0.04, 0.01, -0.01])
    assert (off.to_face(0, 1.0), off.to_face(0, -1.0)) == pytest.approx((0.04, 0.02))


def test_the_room_behind_a_point_is_that_of_the_part_it_lies_in():
    parts = [
        {"size_m": [0.2, 0.1, 0.02], "position": [0.0, 0.0, 0.0]},
        {"size_m": [0.02, 0.06, 0.02], "position": [0.0, 0.08, 0.0]},
    ]
    pan, back = thing(size=(0.2, 0.21, 0.02), parts=parts), np.array([1.0, 0.0, 0.0])
    assert pan.room_behind(np.array([0.02, 0.0, 0.0]), back) == pytest.approx(0.12)
    assert pan.room_behind(np.array([0.0, 0.08, 0.0]), back) == pytest.approx(0.01)
    assert pan.room_behind(np.array([0.0, 0.08, 0.0]), -back) == pytest.approx(0.01)
    assert pan.room_behind(np.array([0.08, 0.08, 0.0]), back) == 0.0


def test_what_is_not_said_of_an_object_is_taken_for_something_ordinary():
    plain = thing(parts=[], middle_m=[0.0, 0.01, 0.0])
    (middle, half), *rest = plain.parts
    assert rest == []
    assert (list(middle), list(half)) == ([0.0, 0.01, 0.0], [0.03, 0.02, 0.01])
    assert (plain.mass, plain.friction) == (0.3, 0.5)


def test_other_objects_are_left_alone_where_there_are_any():
    two = written({"brick": brick(), "cup": brick(), "can": brick()})
    assert "3.0 * (norm(self.cup_vel) + norm(self.can_vel))" in disturbance_term(two, "brick")
    assert disturbance_term(written({"brick": brick()}), "brick") == ""


def test_numbers_are_written_short_and_without_a_negative_zero():
    assert number(0.123456) == "0.1235"
    assert number(-0.00001) == "0"
    assert vector([0.123456, -0.00001, 2]) == "np.array([0.1235, 0, 2])"
    assert axis_of("box", 1, -1.0, "init_quat") == "-1.0 * quat_axis(self.box_init_quat, 1)"
