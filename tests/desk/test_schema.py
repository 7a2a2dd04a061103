from typing import Annotated, Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from coral.desk.schema import MAX_FAULTS, faults
from coral.reef.decide.answers import CentroidChoice, WaypointChoice


class Part(BaseModel):
    label: str = Field(min_length=1, max_length=8)
    mass: float = Field(gt=0, le=50)


class Everything(BaseModel):
    model_config = ConfigDict(extra="forbid")

    mode: Literal["push", "pull"]
    count: int = Field(ge=-6, le=6)
    index: int | None
    parts: list[Part] = Field(default=[], max_length=2)
    pair: tuple[float, float] = (0.0, 0.0)
    flag: bool = False
    table: dict[str, int] = {}


GOOD: dict[str, Any] = {"mode": "push", "count": 2, "index": None}
SCHEMA = Everything.model_json_schema()


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"count": 2.0},
        {"parts": [{"label": "mug", "mass": 0.5}]},
        {"pair": [1, 2.5]},
        {"table": {"a": 1}},
    ],
)
def test_fitting_answers(more):
    assert faults({**GOOD, **more}, SCHEMA) == []
    Everything.model_validate({**GOOD, **more})


@pytest.mark.parametrize(
    ("more", "place", "reason"),
    [
        ({"mode": "lift"}, "mode", "'lift' is not one of"),
        ({"count": 7}, "count", "7 is greater than the maximum of 6"),
        ({"count": 1.5}, "count", "1.5 is not of type 'integer'"),
        ({"count": True}, "count", "True is not of type 'integer'"),
        ({"parts": [{"label": "mug", "mass": 0}]}, "parts.0.mass", "0 is less than or equal to the minimum of 0"),
        ({"parts": [{"label": "mug"}]}, "parts.0.mass", "is missing"),
        ({"parts": [{"label": "mug", "mass": 1}] * 3}, "parts", "[{'label'"),
        ({"pair": [1]}, "pair", "[1] is too short"),
        ({"pair": [1, "b"]}, "pair.1", "'b' is not of type 'number'"),
        ({"other": 1}, "", "Additional properties are not allowed"),
    ],
)
def test_faults_name_the_place_and_the_reason(more, place, reason):
    fault, *_ = faults({**GOOD, **more}, SCHEMA)
    assert (fault.place, reason in fault.reason) == (place, True)
    # What pydantic takes for a number in lax mode (true, "2") is still no number to a person.
    if place != "count":
        with pytest.raises(ValidationError):
            Everything.model_validate({**GOOD, **more})


def test_the_bounds_of_a_reef_waypoint_are_checked():
    assert faults({"forward_m": 6, "left_m": -6}, WaypointChoice.model_json_schema()) == []
    (fault,) = faults({"forward_m": 7, "left_m": 0}, WaypointChoice.model_json_schema())
    assert fault.place == "forward_m"
    (fault,) = faults({}, CentroidChoice.model_json_schema())
    assert (fault.place, fault.reason) == ("selected_centroid_index", "is missing")


def test_many_faults_are_cut_and_self_reference_ends():
    assert len(faults([{}] * 50, {"items": {"required": ["a"]}})) == MAX_FAULTS
    loop = {"$ref": "#/$defs/a", "$defs": {"a": {"$ref": "#/$defs/a"}}}
    assert "nested too deeply" in faults(1, loop)[0].reason


@pytest.mark.parametrize("schema", [{"$ref": "http://127.0.0.1:9/schema"}, {"type": 3}, {"pattern": "("}])
def test_a_schema_from_elsewhere_that_cannot_be_followed_refuses_the_answer(schema):
    assert "cannot be checked" in faults("text", schema)[0].reason


class Numbers(BaseModel):
    a: Annotated[int, Field(strict=True, gt=-3, le=4, multiple_of=2)]
    b: Annotated[float, Field(strict=True, ge=0.5, lt=2.5)] | None


@given(st.integers(-6, 8), st.none() | st.floats(-1, 4) | st.integers(-1, 4))
def test_agrees_with_pydantic(a, b):
    value = {"a": a, "b": b}
    try:
        Numbers.model_validate(value)
        fits = True
    except ValidationError:
        fits = False
    assert (faults(value, Numbers.model_json_schema()) == []) == fits


@pytest.mark.parametrize("value", [int("9" * 400), -int("9" * 4000)], ids=["400 digits", "4000 digits"])
def test_numbers_that_no_float_holds_are_checked_too(value):
    (fault,) = faults(value, {"type": "integer", "minimum": 0, "maximum": 3})
    assert len(fault.reason) <= 300
    assert faults(value, {"type": "number", "multipleOf": 0.5})
