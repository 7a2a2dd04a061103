from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.validation_errors import input_error, shown


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Ball(Part):
    kind: Literal["ball"] = "ball"
    radius_m: float = Field(gt=0)


class Box(Part):
    kind: Literal["box"] = "box"
    size_m: tuple[float, float, float]


class Origin(Part):
    latitude: float
    longitude: float


class Scene(Part):
    name: str = Field(pattern="^[a-z]+$")
    things: list[Annotated[Ball | Box, Field(discriminator="kind")]] = Field(min_length=1)
    at: dict[str, tuple[float, float]] = {}
    origin: Origin | None = None

    @model_validator(mode="after")
    def placed(self):
        if len(self.at) > 1:
            raise ValueError("at most one place")
        return self


GOOD = {"name": "pond", "things": [{"kind": "ball", "radius_m": 1.0}]}


def said(**changes):
    with pytest.raises(ValidationError) as error:
        Scene.model_validate({key: value for key, value in {**GOOD, **changes}.items() if value is not ...})
    return str(input_error("a.yaml", error.value, Scene))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"things": [{"kind": "ball", "radius_m": -1}]}, "things[0].radius_m: found -1, expected greater than 0"),
        ({"things": [{"kind": "ball"}]}, "things[0].radius_m: found nothing, expected a value"),
        ({"things": [{"radius_m": 1}]}, "things[0].kind: found nothing, expected a value"),
        (
            {"things": [{"kind": "bal"}]},
            "things[0].kind: found 'bal', expected one of ball, box (did you mean 'ball'?)",
        ),
        (
            {"things": [{"kind": "ball", "radius_m": 1, 0: None}]},
            "things[0].0: found an unknown key, expected one of kind, radius_m",
        ),
        ({"things": []}, "things: found 0 entries, expected at least 1"),
        ({"things": [3]}, "things[0]: found 3, expected a mapping"),
        ({"at": {"a": 3}}, "at.a: found 3, expected a list"),
        ({"at": {"a": [3]}}, "at.a: found [3], expected 2 entries"),
        ({"things": [{"kind": "box", "size_m": []}]}, "things[0].size_m: found [], expected 3 entries"),
        ({"name": "Pond"}, "name: found 'Pond', expected text like '^[a-z]+$'"),
        ({"name": ...}, "name: found nothing, expected a value"),
        ({"colour": 1}, "colour: found an unknown key, expected one of name, things, at, origin"),
    ],
)
def test_the_line_names_the_place_as_the_file_has_it(changes, line):
    assert said(**changes) == f"a.yaml: {line}"


def test_what_a_validator_of_ours_says_is_told_as_it_is():
    assert said(at={"a": [1, 2], "b": [1, 2]}).endswith("..., expected at most one place")


def test_a_misspelt_key_is_told_before_the_one_that_is_missing_for_it():
    changed = {"things": [{"kind": "box", "siez_m": [1, 1, 1]}]}
    assert said(**changed) == (
        "a.yaml: things[0].siez_m: found an unknown key, expected one of kind, size_m (did you mean 'size_m'?)"
    )


def test_a_long_value_is_cut():
    assert shown("x" * 100) == "'" + "x" * 56 + "..."
    assert shown([1, 2]) == "[1, 2]"


def test_a_misspelt_key_of_a_part_that_may_be_missing():
    assert said(origin={"latitude": 54.3, "ongitude": 10.2}) == (
        "a.yaml: origin.ongitude: found an unknown key, expected one of latitude, longitude (did you mean 'longitude'?)"
    )
