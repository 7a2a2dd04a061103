"""Answers to the reef's questions, and to those of a mission in words."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

REASON_LIMIT = 4000
"""Characters kept of a reason. A longer reason is cut, not refused."""


def _no_bool(value: Any) -> Any:
    """Reject True and False, which Python accepts as 1 and 0."""
    if isinstance(value, bool):
        raise PydanticCustomError("number_type", "Input should be a whole number, not true or false")
    return value


def shorten(value: Any) -> Any:
    """Cut a text that is too long."""
    return value[:REASON_LIMIT] if isinstance(value, str) else "" if value is None else value


def keep_first(most: int) -> BeforeValidator:
    """Keep the first `most` items of a list: a model that names more goals than are kept is not wrong for it."""
    return BeforeValidator(lambda value: value[:most] if isinstance(value, (list, tuple)) else value or ())


Step = Annotated[int, Field(ge=-6, le=6), BeforeValidator(_no_bool)]
"""The bounds stand before the validator because pydantic leaves them out of the JSON schema otherwise."""
Index = Annotated[int, BeforeValidator(_no_bool)]
Text = Annotated[str, Field(max_length=REASON_LIMIT), BeforeValidator(shorten)]

_MOVE = re.compile(r"(forward|backward|back|left|right)\w*(?:\s+by)?\s+(\d+(?:\.\d+)?)", re.IGNORECASE)
_SIGN = {
    "forward": ("forward_m", 1),
    "backward": ("forward_m", -1),
    "back": ("forward_m", -1),
    "left": ("left_m", 1),
    "right": ("left_m", -1),
}


class Expectation(BaseModel):
    """What an advisor expects where the map shows nothing."""

    model_config = ConfigDict(frozen=True)

    what: Text = Field(description="what you expect, such as: the line of clusters goes on behind the rock")
    forward_m: Annotated[float, Field(ge=-60, le=60, allow_inf_nan=False)] | None = Field(
        default=None, description="where, metres forward; null: at the goal"
    )
    left_m: Annotated[float, Field(ge=-60, le=60, allow_inf_nan=False)] | None = Field(
        default=None, description="where, metres to the left; null: at the goal"
    )
    sure: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.5, description="how sure you are, 0 to 1"
    )


class WaypointStep(BaseModel):
    """A waypoint in whole metres in the robot frame."""

    model_config = ConfigDict(frozen=True)

    forward_m: Step
    left_m: Step


class CentroidAnswer(BaseModel):
    """Answer in centroid selection mode (paper III-C.1, Prompt B)."""

    model_config = ConfigDict(frozen=True)

    selected_centroid_index: Index | None = Field(description="label of the chosen orange dot; null when there is none")
    reason: Text = ""


class CentroidChoice(CentroidAnswer):
    """The same with what goes beyond the paper: further goals, a waypoint in place of a dot, a guess, the end."""

    then: Annotated[tuple[Index, ...], keep_first(3)] = Field(
        default=(), max_length=3, description="labels of the dots to go to after it, in order; may be empty"
    )
    waypoint: WaypointStep | None = Field(
        default=None, description="a place to go to instead of a dot; then selected_centroid_index is null"
    )
    expect: Expectation | None = Field(default=None, description="what you expect beyond the map, if you go for that")
    end_survey: bool = Field(default=False, description="true: nothing that is left is worth going to")


class WaypointAnswer(BaseModel):
    """Answer in free waypoint mode (paper III-C.2, Prompt A): whole metres in the robot frame."""

    model_config = ConfigDict(frozen=True)

    forward_m: Step = Field(description="metres forward (negative: backward), -6 to 6")
    left_m: Step = Field(description="metres to the left (negative: right), -6 to 6")
    reason: Text = ""

    @model_validator(mode="before")
    @classmethod
    def _from_sentence(cls, value: Any) -> Any:
        """Accept the paper's form too: {"Move forward 4 meters, move right 1 meter": "reason"} (Prompt A)."""
        if not isinstance(value, dict) or len(value) != 1:
            return value
        ((sentence, reason),) = value.items()
        moves = _MOVE.findall(sentence) if isinstance(sentence, str) else []
        if not moves:
            return value
        parts: dict[str, Any] = {"forward_m": 0, "left_m": 0, "reason": reason if isinstance(reason, str) else ""}
        for direction, metres in moves:
            name, sign = _SIGN[direction.lower()]
            parts[name] = sign * float(metres)
        return parts


class WaypointChoice(WaypointAnswer):
    """The same with what goes beyond the paper: further goals, a dot in its place, a guess, the rest, the end."""

    then: Annotated[tuple[WaypointStep, ...], keep_first(2)] = Field(
        default=(), max_length=2, description="waypoints to go to after it, in the same frame; may be empty"
    )
    dot: Index | None = Field(default=None, description="label of an orange dot to go to instead of the waypoint")
    expect: Expectation | None = Field(default=None, description="what you expect beyond the map, if you go for that")
    explore_rest: bool = Field(
        default=False,
        description="true: no dot is left, and the robot explores by its own tour until it finds something",
    )
    end_survey: bool = Field(default=False, description="true: nothing that is left is worth going to")


class LookFrom(BaseModel):
    """A look at something from a side of one's choice. It costs the time of the way."""

    model_config = ConfigDict(frozen=True)

    dot: Index = Field(description="label of the dot to look at")
    side: Literal["near", "left", "right", "far"] = Field(
        default="near", description="from which side, as seen from the arrows' origin; far: from behind it"
    )
    distance_m: Annotated[float, Field(ge=1.0, le=6.0, allow_inf_nan=False)] = Field(
        default=1.5, description="how near to come (m)"
    )


class Mark(BaseModel):
    """What something was found to be."""

    model_config = ConfigDict(frozen=True)

    dot: Index
    label: Text = Field(description="what it is, in a few words")


class MissionAnswer(CentroidAnswer):
    """Where next, what to look at, what is ruled out or found, and whether the mission is done."""

    selected_centroid_index: Index | None = Field(default=None, description="label of a dot to go to; null if none")
    then: Annotated[tuple[Index, ...], keep_first(3)] = Field(
        default=(), max_length=3, description="labels of the dots to go to after it, in order; may be empty"
    )
    waypoint: WaypointStep | None = Field(default=None, description="a place to go to instead")
    look: LookFrom | None = Field(default=None, description="a look at a dot, from near or from another side, instead")
    home: bool = Field(default=False, description="true: go back to the start instead")
    done: bool = Field(default=False, description="true: the mission is done; it ends here and now")
    answer: Text = Field(default="", description="with done: the answer to what the instruction asks, if it asks")
    skip: Annotated[tuple[Index, ...], keep_first(20)] = Field(
        default=(), max_length=20, description="labels of dots that are ruled out"
    )
    marks: Annotated[tuple[Mark, ...], keep_first(20)] = Field(
        default=(), max_length=20, description="what dots were found to be"
    )

    @property
    def end_survey(self) -> bool:
        """Whether it ends the survey."""
        return self.done
