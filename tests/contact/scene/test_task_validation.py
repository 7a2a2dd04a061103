import numpy as np
import pytest
from contact_bench import changed, plain, stl

from coral.contact.control.quantities import task_schema_of
from coral.contact.scene.task import Task
from coral.contact.scene.task_validation import RESERVED, check_task
from coral.errors import InputError

BOX = plain()["objects"][0]
GOOD = {"kind": "released", "object": "a"}


def check(content):
    check_task(Task.model_validate(content), "task.yaml")


def refusal(content):
    """Field and text of the refusal."""
    with pytest.raises(InputError) as refused:
        check(content)
    assert refused.value.where == "task.yaml"
    return refused.value.field, str(refused.value)


def three(**points):
    """Objects whose names could be taken for each other's quantities; the first one has these points."""
    objects = [BOX | {"name": name, "y": y, "points": {}} for name, y in (("a", 0), ("a_b", 0.2), ("b", -0.2))]
    objects[0]["points"] = points
    return plain() | {"objects": objects, "success": {"conditions": [GOOD]}}


def test_a_plain_task_is_sound():
    check(plain())


@pytest.mark.parametrize(("z", "fine"), [(0.1, True), (0.9, False)])
def test_an_object_cannot_rest_on_a_thing_far_below_its_goal(z, fine):
    at = {"kind": "at", "object": "box", "place": "spot", "axes": "xyz", "tolerance_m": 0.03}
    resting = {"kind": "resting", "object": "box", "thing": "wall"}
    task = plain() | {"places": {"spot": [0, 0, z]}, "success": {"conditions": [at, resting]}}
    if fine:
        check(task)
    else:
        field, text = refusal(task)
        assert field == "places.spot[2]"
        assert "where the box can rest on the wall" in text


@pytest.mark.parametrize("name", [*sorted(RESERVED), "robot0_box", "gripper0_right_eef", "fixed_mount0_base", "wall"])
def test_names_of_the_robot_and_of_the_record_are_taken(name):
    field, text = refusal(
        plain() | {"objects": [BOX | {"name": name}], "success": {"conditions": [GOOD | {"object": name}]}}
    )
    assert field == "objects[0].name"
    assert "expected a name that is not taken" in text


def test_of_two_things_of_one_name_the_second_is_refused():
    assert refusal(plain() | {"objects": [BOX, BOX | {"y": 0.2}]})[0] == "objects[1].name"
    assert refusal(plain() | {"fixtures": [*plain()["fixtures"], plain()["fixtures"][0]]})[0] == "fixtures[1].name"


def test_costs_read_every_name_once():
    check(three())
    assert "a_a_b_contact" in task_schema_of(Task.model_validate(three()))
    # a_b_pos is the other object's
    assert "a second meaning of a_b_pos" in refusal(three(b=[0, 0, 0]))[1]


@pytest.mark.parametrize(
    ("key", "value", "field"),
    [
        ("places", {"box": [0, 0, 0]}, "places.box"),
        ("places", {"ee": [0, 0, 0]}, "places.ee"),
        ("numbers", {"time": 3}, "numbers.time"),
        ("numbers", {"box_pos": 3}, "numbers.box_pos"),
        ("numbers", {"goal_pos": 3}, "numbers.goal_pos"),
        ("numbers", {"wall_size": 3}, "numbers.wall_size"),
    ],
)
def test_places_and_numbers_may_not_have_a_name_that_costs_read_otherwise(key, value, field):
    assert refusal(plain() | {key: plain()[key] | value})[0] == field


def test_a_point_may_not_be_named_as_what_an_object_has_by_itself():
    field, text = refusal(changed("objects.0.points", {"init": [0, 0, 0]}))
    assert field == "objects[0].points"
    assert "unlike init" in text


@pytest.mark.parametrize(("x", "ok"), [([-0.4, 0.4], True), ([0.3, 0.41], False), (-0.41, False)])
def test_an_object_begins_over_the_table_unless_its_height_is_given(x, ok):
    content = changed("objects.0.x", x)
    if ok:
        check(content)
    else:
        assert "on the table, from -0.4 to 0.4" in refusal(content)[1]
    check(content | {"objects": [content["objects"][0] | {"z": 0.5}]})


def test_success_must_fit_into_the_time():
    success = plain()["success"] | {"hold_s": 0.5}
    check(plain() | {"time_limit_s": 0.5, "success": success})
    field, text = refusal(plain() | {"time_limit_s": 0.4, "success": success})
    assert field == "success.hold_s"
    assert "found 0.5 s, expected no more than the time limit, 0.4 s" in text


def test_conditions_are_checked_by_their_place():
    conditions = [plain()["success"]["conditions"][0], {"kind": "released", "object": "bix"}]
    field, text = refusal(plain() | {"success": {"conditions": conditions}})
    assert field == "success.conditions[1].object"
    assert "did you mean 'box'?" in text


def test_a_condition_may_not_name_what_nobody_is_told_of():
    at_wall = {"kind": "resting", "object": "box", "thing": "wall"}
    task = changed("fixtures.0.hidden", True) | {"success": {"conditions": [at_wall]}}
    assert refusal(task)[0] == "success.conditions[0].thing"


def meshed(path, size=(1, 1, 1)):
    return changed("objects.0.parts.0", {"shape": "mesh", "file": str(path), "size": list(size)})


@pytest.mark.parametrize("edge", [0.0005, 100.0])
def test_a_mesh_in_other_units_is_told(tmp_path, edge):
    path = stl(tmp_path / "m.stl", corners=edge * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]))
    field, text = refusal(meshed(path))
    assert field == "objects[0].parts[0].size"
    assert f"make the mesh {edge:g} x {edge:g} x {edge:g} m large" in text


@pytest.mark.parametrize(
    ("name", "content"),
    [("no.stl", None), ("a.ply", b"ply"), ("a.stl", b"solid nothing"), ("a.obj", b"v 0 0 0\n"), ("a.stl", bytes(84))],
)
def test_a_file_that_is_no_mesh_is_refused(tmp_path, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    field, text = refusal(meshed(tmp_path / name))
    assert field == "objects[0].parts[0].file"
    assert name in text


@pytest.mark.parametrize(
    ("name", "reason"),
    [("step", "a column of the run's logs"), ("palm", "a part of the robot"), ("wall", "also fixtures[0].name")],
)
def test_a_name_that_is_taken_is_refused_with_the_reason(name, reason):
    objects = [BOX | {"name": name}]
    _, text = refusal(plain() | {"objects": objects, "success": {"conditions": [GOOD | {"object": name}]}})
    assert text.endswith(f"expected a name that is not taken: this one is {reason}")


@pytest.mark.parametrize(
    ("others", "expected"),
    [({"a": "c"}, "one of a_b, b"), ({"a": "a"}, "one of a_b, b"), ({"a": "b", "b": "a"}, "ends on the table")],
)
def test_a_stack_stands_on_other_objects_and_on_the_table(others, expected):
    content = three()
    for item in content["objects"]:
        if item["name"] in others:
            item["stands_on"] = others[item["name"]]
    field, text = refusal(content)
    assert field == "objects[0].stands_on"
    assert expected in text
