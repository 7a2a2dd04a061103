"""The answer to a question of a mission in words."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from coral.reef.decide.answers import CentroidAnswer, Index, Text, WaypointStep, keep_first


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
