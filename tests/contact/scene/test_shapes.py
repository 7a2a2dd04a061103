import pytest
from contact_bench import plain
from pydantic import ValidationError

from coral.contact.scene.shapes import Fixture, Movable, Shape, in_order

BOX = plain()["objects"][0]


def test_one_number_is_a_range_and_whole_numbers_are_numbers():
    box = Movable.model_validate(BOX)
    assert (box.x, box.mass_kg, box.scale) == ((0, 0), (0.2, 0.2), ((1, 1), (1, 1), (1, 1)))
    assert Movable.model_validate(BOX | {"yaw_deg": [-90, 90]}).yaw_deg == (-90, 90)


def test_a_range_begins_with_its_lower_end():
    assert in_order((0.1, 0.1)) == (0.1, 0.1)
    with pytest.raises(ValueError, match="lower end first"):
        in_order((0.2, 0.1))


@pytest.mark.parametrize("value", [True, "0.2", None, float("nan"), [0.1, True]])
def test_what_only_looks_like_a_number_is_none(value):
    with pytest.raises(ValidationError, match="mass_kg"):
        Movable.model_validate(BOX | {"mass_kg": value})


@pytest.mark.parametrize(
    "part",
    [
        {"shape": "cylinder", "size": [0.1, 0.1, 0.3]},
        {"shape": "sphere", "size": [0.1, 0.1, 0.1]},
        {"shape": "mesh", "size": [1.0, 1.0, 1.0], "file": "part.stl"},
        {"size": [0.1, 0.2, 0.3]},
    ],
)
def test_a_shape_with_sizes_that_fit_it_is_accepted(part):
    assert Shape.model_validate(part).shape == part.get("shape", "box")


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"shape": "cylinder", "size": [0.1, 0.2, 0.1]}, "a cylinder whose first two sizes are equal"),
        ({"shape": "sphere", "size": [0.1, 0.2, 0.2]}, "a sphere whose first two sizes are equal"),
        ({"shape": "sphere", "size": [0.1, 0.1, 0.2]}, "a sphere whose three sizes are equal"),
        ({"shape": "mesh", "size": [1.0, 1.0, 1.0]}, "a mesh with its file"),
        ({"size": [1.0, 1.0, 1.0], "file": "part.stl"}, "or another shape without one"),
    ],
)
def test_a_shape_with_other_sizes_is_refused(part, words):
    with pytest.raises(ValidationError, match=words):
        Shape.model_validate(part)


def test_a_part_of_a_task_is_a_value_and_has_no_other_keys():
    wall = Fixture(name="wall", size=(0.1, 0.1, 0.1), position=(0.0, 0.0, 0.05))
    with pytest.raises(ValidationError, match="frozen"):
        wall.yaw_deg = 3.0
    with pytest.raises(ValidationError, match="extra"):
        Fixture.model_validate(wall.model_dump() | {"mass_kg": 1.0})
