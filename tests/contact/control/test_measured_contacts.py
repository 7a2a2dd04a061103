import dataclasses

import numpy as np
import pytest

from coral.contact.control.measured_contacts import sunk_into, touched_by, with_measured_contacts

NOTHING = {"left": (), "right": (), "hand": ()}


def observed(one, offset, opening=0.08, force=(0.0, 0.0, 0.0)):
    """The hand, palm down, at an offset from the box, feeling a force."""
    tool = dataclasses.replace(
        one.now.tool,
        position=one.now.objects["box"].position + np.asarray(offset),
        quaternion=np.array([0.0, 1.0, 0, 0]),
    )
    return dataclasses.replace(one.now, tool=tool, opening_m=opening, wrench=np.array([*force, 0.0, 0.0, 0.0]))


@pytest.fixture
def one(scene):
    return scene("pick-box")


def test_where_nothing_is_felt_nothing_is_touched(one):
    above = one.sizes["box"][2] / 2 + 0.008
    assert touched_by(one.world, observed(one, (0, 0, above)), 0.08) == NOTHING


def test_a_force_next_to_an_object_is_a_touch_of_it(one):
    above = one.sizes["box"][2] / 2 + 0.01
    found = touched_by(one.world, observed(one, (0, 0, above), opening=0.0, force=(0, 0, 5.0)), 0.0)
    assert found == {"left": ("box",), "right": ("box",), "hand": ()}


def test_a_force_far_from_everything_touches_nothing_that_is_known(one):
    assert touched_by(one.world, observed(one, (0, 0, 0.2), force=(0, 0, 5.0)), 0.08) == NOTHING


def test_fingertips_on_the_table_touch_the_table(one):
    low = 0.008 - one.now.objects["box"].position[2]
    found = touched_by(one.world, observed(one, (0.0, 0.15, low), force=(0, 0, 40.0)), 0.08)
    assert found["left"] == found["right"] == ("table",)


def test_fingers_three_centimetres_above_the_table_do_not_touch_it(one):
    """MuJoCo's own distance is 0 at some of these places."""
    for x in np.arange(-0.16, 0.17, 0.02):
        found = touched_by(one.world, observed(one, (x, 0.15, 0.02), force=(0, 0, 5.0)), 0.08)
        assert "table" not in found["left"] + found["right"]


def test_fingers_that_are_held_apart_hold_what_is_between_them(one):
    width = min(one.sizes["box"][:2])
    turned = one.now.objects["box"]
    now = observed(one, (0, 0, 0.0), opening=width)
    narrow = dataclasses.replace(turned, quaternion=np.array([1.0, 0.0, 0.0, 0.0]))
    if one.sizes["box"][0] < one.sizes["box"][1] - 0.004:
        narrow = dataclasses.replace(turned, quaternion=np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]))
    now = dataclasses.replace(now, objects={"box": narrow})
    assert touched_by(one.world, now, 0.0) == {"left": ("box",), "right": ("box",), "hand": ()}
    assert touched_by(one.world, now, width) == NOTHING


def test_conditions_read_the_measured_contacts_and_forces(one):
    now = observed(one, (0, 0, 0.2), force=(1.0, 2.0, 3.0))
    state = one.world.present(one.now)
    found = with_measured_contacts(state, now, {"left": ("box",), "right": (), "hand": ()})
    assert (found.box_left_contact, found.box_right_contact, found.box_hand_contact) == (1.0, 0.0, 1.0)
    np.testing.assert_array_equal(found.ee_force[0, 0], [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(found.box_hand_force[0, 0], [-1.0, -2.0, -3.0])
    np.testing.assert_array_equal(found.box_pos, state.box_pos)
    nothing = with_measured_contacts(state, now, NOTHING)
    assert not nothing.box_hand_contact
    assert not nothing.box_hand_force.any()


def test_a_hand_beside_an_object_is_not_inside_and_closed_fingers_in_its_middle_are(one):
    assert sunk_into(one.world, observed(one, (0, 0, 0.2))) == {"box": 0.0}
    half = min(one.sizes["box"]) / 2
    deep = sunk_into(one.world, observed(one, (0, 0, 0.0), opening=0.0))["box"]
    assert 0.5 * half < deep < 2.0 * half + 0.02


def test_conditions_read_what_the_palm_touches_and_what_the_hand_does_to_the_table(one):
    now = observed(one, (0, 0, 0.2), force=(0.0, 0.0, 7.0))
    state = one.world.present(one.now)
    found = with_measured_contacts(state, now, {"left": ("table",), "right": (), "hand": ()})
    assert (found.table_hand_contact, found.table_palm_contact, found.box_hand_contact) == (1.0, 0.0, 0.0)
    np.testing.assert_array_equal(found.table_hand_force[0, 0], [0.0, 0.0, -7.0])
    palm = with_measured_contacts(state, now, {"left": (), "right": (), "hand": ("box",)})
    assert (palm.box_palm_contact, palm.table_hand_contact) == (1.0, 0.0)
    assert not palm.table_hand_force.any()
    assert palm.box_hand_clearance[0, 0] == state.box_hand_clearance[0, 0]
