"""What the reef's questions are answered with."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Step = Annotated[int, Field(ge=-6, le=6)]


class CentroidChoice(BaseModel):
    """Answer in centroid selection mode (paper III-C.1)."""

    model_config = ConfigDict(frozen=True)

    selected_centroid_index: int | None = Field(description="label of the chosen orange dot; null when there is none")
    reason: str = Field(default="", max_length=4000)


class WaypointChoice(BaseModel):
    """Answer in free waypoint mode (paper III-C.2): whole metres in the robot frame."""

    model_config = ConfigDict(frozen=True)

    forward_m: Step = Field(description="metres forward (negative: backward), -6 to 6")
    left_m: Step = Field(description="metres to the left (negative: right), -6 to 6")
    reason: str = Field(default="", max_length=4000)
