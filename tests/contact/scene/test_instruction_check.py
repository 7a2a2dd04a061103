"""Words of an instruction that nothing in the task answers are pointed out."""

import pytest
from contact_bench import make_trial, plain

from coral.contact.scene.instruction_check import is_colour, unmatched_words
from coral.contact.scene.task_names import every_task
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


def test_a_purpose_is_no_order():
    assert told("Turn it in order to see its back.") == []


def test_a_thing_that_is_not_there_is_pointed_out():
    assert told("Put it on the mat.") == ["'mat': no object, fixture, place, point or mark is called so"]
    mat = {"places": {"mat": [0.1, 0.0, 0.0]}}
    assert told("Put it on the mat.", **mat) == [
        "'mat': a place is called so, but nothing is seen there; `marks` draw it"
    ]
    assert told("Put it on the mat.", **mat, marks=[{"place": "mat", "color": [0.3, 0.6, 0.3]}]) == []
    assert told("Put it on the goal.") == []


@pytest.mark.parametrize("word", ["purple", "violet", "pink", "brown", "turquoise", "cyan", "magenta", "beige"])
def test_common_names_of_colours_are_known(word):
    assert told(f"Lift the {word} box.", objects=[BOX | {"color": [0.1, 0.2, 0.7]}]) == [
        f"{word!r}: nothing in the scene has this colour"
    ]


def test_a_mark_has_the_colour_that_it_is_said_to_have():
    red = [BOX | {"color": [0.8, 0.2, 0.2]}]
    scene = {"objects": red, "places": {"mark": [0.1, 0.0, 0.0], "line": [0.2, 0.0, 0.0]}}
    green = {"place": "mark", "color": [0.3, 0.6, 0.3]}
    assert told("Push it to the red mark.", **scene, marks=[green]) == ["'red mark': no mark has this colour"]
    assert told("Push it to the green mark.", **scene, marks=[green]) == []
    assert told("Push it over the red line.", **scene, marks=[green | {"place": "line"}]) == [
        "'red line': no line has this colour"
    ]
    assert "'red mark': no mark has this colour" in told("Push the red box to the red mark.", **scene)


def test_amounts_in_words_and_speeds():
    near = [{"kind": "kept-near", "object": "box", "distance_m": 0.04}]
    assert told("Not more than four centimetres.", success={"conditions": near}) == []
    assert told("Not more than five centimetres.", success={"conditions": near}) == [
        "'five centimetres': no condition has this amount"
    ]
    turned = [{"kind": "flipped", "object": "box", "degrees": 25}]
    assert told("Turn it by twenty-five degrees.", success={"conditions": turned}) == []
    # A length is no speed.
    assert told("Move it with 4 cm/s.", success={"conditions": near}) == ["'4 cm/s': no condition has this amount"]
    still = [{"kind": "still", "object": "box", "speed_m_s": 0.05}]
    for words in ("Slower than 5 cm/s.", "Slower than 5 cm per second.", "Slower than five centimetres a second."):
        assert told(words, success={"conditions": still}) == []
    assert told("Move it with 5 cm/s.", numbers={"pace": 0.05}) == []


DEEDS = [
    ("Slide it without lifting it.", "without lifting", {"kind": "kept-touching"}),
    ("Do not lift it.", "do not lift", {"kind": "slid", "distance_m": 0.1}),
    ("Push it along the table.", "along the table", {"kind": "kept-touching"}),
    ("Do not lift or topple it.", "not lift or topple", {"kind": "kept-level"}),
    ("Let go of it.", "let go", {"kind": "released"}),
    ("Lift it by its corner, not by its handle.", "by its handle", {"kind": "grasped", "point": "corner"}),
    ("Move it without touching the wall.", "without touching", {"kind": "never-touched", "thing": "wall"}),
    ("Push it without a blow.", "without a blow", {"kind": "peak-force", "newtons": 20}),
    ("Raise and lower it, in this order.", "in this order",
     {"kind": "sequence", "events": [[{"kind": "released", "object": "box"}]] * 2}),
]  # fmt: skip


@pytest.mark.parametrize(("words", "deed", "judge"), DEEDS)
def test_a_deed_that_no_condition_judges_is_pointed_out(words, deed, judge):
    other = {"conditions": [{"kind": "inside", "object": "box", "low": [-1, -1, -1], "high": [1, 1, 1]}]}
    assert any(one.startswith(f"{deed!r}: no condition judges it") for one in told(words, success=other))
    judged = {"conditions": [*other["conditions"], {"object": "box", **judge}]}
    assert not any(one.startswith(repr(deed)) for one in told(words, success=judged))


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
