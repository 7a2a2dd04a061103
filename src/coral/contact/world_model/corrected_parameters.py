"""Corrected masses and frictions from an advisor (A.9), and the check of their bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping

from pydantic import BaseModel, Field, model_validator

from coral.advisor.question import Rejection
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model.parameter_estimates import FRICTION, MASS_KG

SAME = 0.01
"""Relative difference up to which a value counts as kept."""


class ObjectParameters(BaseModel):
    """One object's corrected parameters (A.9.2)."""

    label: str
    mass: float
    friction: float


class ParametersAnswer(BaseModel):
    """The world-model correction."""

    objects: list[ObjectParameters] = Field(min_length=1, max_length=8)

    @model_validator(mode="after")
    def _one_entry_each(self) -> ParametersAnswer:
        labels = [one.label for one in self.objects]
        twice = sorted({label for label in labels if labels.count(label) > 1})
        if twice:
            raise ValueError(f"two entries for {', '.join(twice)}; give one for each object")
        return self

    def keeps(self, believed: Mapping[str, PhysicalParameters]) -> bool:
        """Check whether the answer keeps all values, to the digits that prompts show."""
        return all(
            one.label in believed
            and math.isclose(one.mass, believed[one.label].mass_kg, rel_tol=SAME)
            and math.isclose(one.friction, believed[one.label].friction, rel_tol=SAME)
            for one in self.objects
        )

    def physical(self, believed: Mapping[str, PhysicalParameters]) -> dict[str, PhysicalParameters]:
        """Return the beliefs with the correction applied."""
        return {**believed, **{one.label: PhysicalParameters(one.mass, one.friction) for one in self.objects}}


def verify_parameters(answer: ParametersAnswer, believed: Mapping[str, PhysicalParameters]) -> Rejection | None:
    """Return why corrected parameters cannot be tried, or None; the replay decides whether they are better."""
    for one in answer.objects:
        if one.label not in believed:
            return Rejection(code="objects", reason=f"{one.label} is no object; there are {', '.join(believed)}")
        for field, value, (low, high) in (("mass", one.mass, MASS_KG), ("friction", one.friction, FRICTION)):
            if not low <= value <= high:
                return Rejection(
                    code="bounds", reason=f"{field} of {one.label} is {value:g}; it lies within {low:g} and {high:g}"
                )
    return None
