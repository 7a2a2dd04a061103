"""The names that a cost may read."""

from coral.contact.cost.schema import HAND, hand_quantities, object_quantities, objects_of, scenery_quantities


def test_an_object_has_its_pose_points_and_contacts():
    names = object_quantities("box", ["handle"], ["table"], ["tin"])
    assert {"box_pos", "box_quat", "box_handle_pos", "box_table_contact", "box_tin_contact"} <= names.keys()
    assert names["box_pos"].size == 3
    assert names["box_hand_contact"].truth
    assert names["box_mass"].constant
    assert not names["box_vel"].constant


def test_scenery_is_constant_and_what_the_hand_does_to_it_is_not():
    names = scenery_quantities(["wall"], ["goal"], ["lift"])
    still = {"wall_pos", "wall_size", "goal_pos", "lift", "table_min", "table_max"}
    assert {name for name, quantity in names.items() if quantity.constant} == still
    assert names.keys() - still == hand_quantities("table").keys() | hand_quantities("wall").keys()


def test_two_things_have_a_contact_and_a_clearance():
    names = object_quantities("box", [], ["table"], ["tin"])
    assert names["box_tin_contact"].truth
    assert (names["box_tin_clearance"].unit, names["box_table_clearance"].size) == ("m", 0)


def test_no_name_of_the_hand_is_an_objects_too():
    assert not HAND.keys() & object_quantities("box").keys()


def test_objects_are_what_has_a_pose_other_than_the_hand():
    names = {**HAND, **object_quantities("box", ["handle"]), **object_quantities("tin"), **scenery_quantities(["wall"])}
    assert objects_of(names) == ["box", "tin"]
