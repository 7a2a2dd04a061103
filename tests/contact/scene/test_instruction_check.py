"""Words of an instruction that nothing in the task answers are pointed out."""

import pytest
from contact_bench import make_trial, plain

from coral.contact.scene.instruction_check import is_colour, unmatched_words
from coral.contact.scene.task_file import every_task
from coral.contact.tasks import load_task

BOX = plain()["objects"][0]


def told(instruction, **changes):
    return unmatched_words(make_trial(**changes).task.model_copy(update={"instruction": instruction}))


def test_a_colour_that_nothing_has_is_pointed_out():
    assert told("Lift the red box.") == ["'red': nothing in the scene has this colour"]
    assert told("Lift the red box.", objects=[BOX | {"color": [0.8, 0.2, 0.2]}]) == []
    edged = [{**BOX["parts"][0], "color": [0.8, 0.2, 0.2]}]
    assert told("Turn its red side.", objects=[BOX | {"parts": edged}]) == []


def test_an_amount_that_no_condition_has_is_pointed_out():
    assert told("Push with 7 N.") == ["'7 N': no condition has this amount"]
    conditions = [{"kind": "kept-near", "object": "box", "distance_m": 0.04}]
    assert told("Turn it without moving it by more than 4 cm.", success={"conditions": conditions}) == []


def test_a_thing_that_is_not_there_is_pointed_out():
    assert told("Put it on the mat.") == ["'mat': no object, fixture, place, point or mark is called so"]
    assert told("Put it on the mat.", places={"mat": [0.1, 0.0, 0.0]}) == []


@pytest.mark.parametrize("name", every_task())
def test_shipped_tasks_have_what_their_words_name(name):
    assert unmatched_words(load_task(name)) == []


@pytest.mark.parametrize(
    ("color", "word", "held"),
    [((0.8, 0.2, 0.2), "red", True), ((0.35, 0.62, 0.4), "green", True), ((0.6, 0.6, 0.62), "grey", True),
     ((0.6, 0.6, 0.62), "blue", False), ((0.95, 0.95, 0.95), "white", True), ((0.2, 0.3, 0.8), "red", False)],
)  # fmt: skip
def test_colours_are_called_as_people_call_them(color, word, held):
    assert is_colour(color, word) is held
