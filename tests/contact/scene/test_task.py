import pytest
from contact_bench import plain
from pydantic import ValidationError

from coral.contact.scene.task import Task


def task(**changes):
    return Task.model_validate(plain() | changes)


def test_an_object_is_found_by_its_name():
    two = [plain()["objects"][0] | {"name": name, "y": y} for name, y in (("box", 0), ("cup", 0.2))]
    assert task(objects=two).object("cup").y == (0.2, 0.2)


def test_what_does_not_move_is_the_table_and_the_fixtures():
    assert task().things == ("table", "wall")
    assert task(fixtures=[]).things == ("table",)


def test_what_is_hidden_stands_there_and_is_not_known():
    wall = plain()["fixtures"][0]
    found = task(fixtures=[wall, wall | {"name": "step", "hidden": True}])
    assert found.things == ("table", "wall", "step")
    assert found.known.things == ("table", "wall")
    assert task().known == task()


def test_a_task_file_of_another_format_is_refused():
    assert task(format="coral-contact/1") == task()
    with pytest.raises(ValidationError, match="coral-contact/1"):
        task(format="coral-contact/2")


def test_a_success_has_a_condition_and_a_bounded_time_to_hold_it():
    conditions = plain()["success"]["conditions"]
    assert task(success={"conditions": conditions}).success.hold_s == 0.5
    for success in ({"conditions": []}, {"conditions": conditions, "hold_s": 31}):
        with pytest.raises(ValidationError, match="success"):
            task(success=success)


def test_a_task_written_out_reads_the_same_again():
    assert Task.model_validate_json(task().model_dump_json()) == task()
