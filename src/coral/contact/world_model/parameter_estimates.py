"""Mass and friction, which no camera shows: estimated by the advisor from the kind of object (section 3.1, A.7).

Or given on the command line: `board=2,0.9;cup=0.2,0.4`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ConfigDict, RootModel

from coral.advisor.question import Rejection
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters
from coral.errors import InputError, nearest

MASS_KG, FRICTION = (0.005, 20.0), (0.02, 2.0)
"""Possible parameters of an object that a hand can move, as in the task format."""
DENSITY_KG_M3 = (5.0, 12_000.0)
"""Bounds on mass over the volume of the bounding box: above air-filled foam, below lead."""
FORM = "NAME=MASS,FRICTION, more than one separated by semicolons"


class ParameterEstimate(BaseModel):
    """One object's parameters."""

    model_config = ConfigDict(allow_inf_nan=True)
    mass_kg: float
    friction_coeff: float


class ParameterEstimates(RootModel[dict[str, ParameterEstimate]]):
    """The completed table of the paper's A.7, by the objects' names."""

    def physical(self) -> dict[str, PhysicalParameters]:
        """Convert to beliefs of the planning world."""
        return {
            name: PhysicalParameters(mass_kg=one.mass_kg, friction=one.friction_coeff)
            for name, one in self.root.items()
        }


def verify_estimates(answer: ParameterEstimates, sizes: Mapping[str, Sequence[float]]) -> Rejection | None:
    """Return why estimates for objects of these full extents (m) are implausible, or None."""
    wanted, given = set(sizes), set(answer.root)
    if wanted != given:
        missing, extra = sorted(wanted - given), sorted(given - wanted)
        parts = [
            f"missing: {', '.join(missing)}" if missing else "",
            f"not in the scene: {', '.join(extra)}" if extra else "",
        ]
        return Rejection(
            code="objects",
            reason=f"{'; '.join(part for part in parts if part)}; give one entry for each of {', '.join(sizes)}",
            details={"missing": missing, "extra": extra},
        )
    for name, one in answer.root.items():
        volume = math.prod(sizes[name])
        for field, value, (low, high), unit in (
            ("mass_kg", one.mass_kg, MASS_KG, " kg"),
            ("friction_coeff", one.friction_coeff, FRICTION, ""),
        ):
            if not (math.isfinite(value) and low <= value <= high):
                return Rejection(
                    code="bounds",
                    reason=f"{field} of {name} is {value:g}; something that this hand can "
                    f"move lies between {low:g} and {high:g}{unit}",
                    details={"object": name},
                )
        low, high = DENSITY_KG_M3
        if not low <= one.mass_kg / volume <= high:
            sides = " x ".join(f"{100 * side:.1f}" for side in sizes[name])
            return Rejection(
                code="density",
                reason=f"{one.mass_kg:g} kg in {sides} cm would be "
                f"{one.mass_kg / volume:.3g} kg/m3 for {name}; materials lie between {low:g} and {high:g}",
                details={"object": name},
            )
    return None


def belief_prompt(facts: SceneFacts) -> dict[str, Any]:
    """Fill the template "physical-parameters": the paper's table, to be completed."""
    return {
        "task": facts["instruction"],
        "objects": {
            name: {
                "label": item["label"],
                "pose_estimated": item["pose"],
                "size_m": item["size_m"],
                "shapes": item["shapes"],
                "solid_share": item["solid_share"],
                **({"parts": item["parts"]} if len(item["parts"]) > 1 else {}),
                "mass_kg": None,
                "friction_coeff": None,
            }
            for name, item in facts["objects"].items()
        },
    }


def parse_beliefs(text: str, task: Task, where: str = "--believe") -> dict[str, PhysicalParameters]:
    """Parse the beliefs about a task's objects.

    Raises:
        InputError: The form is wrong, an object is unknown or repeated, or a value is out of bounds.
    """
    names = [item.name for item in task.objects]
    found: dict[str, PhysicalParameters] = {}
    for word in (part.strip() for part in text.split(";") if part.strip()):
        name, _, values = (part.strip() for part in word.partition("="))
        try:
            mass, friction = (float(value) for value in values.split(","))
        except ValueError:
            raise InputError(where, "", repr(word), FORM) from None
        if name not in names:
            raise InputError(
                where, "", repr(name), f"an object of {task.name}: {', '.join(names)}{nearest(name, names)}"
            )
        if name in found:
            raise InputError(where, "", f"{name!r} twice", "each object once")
        for what, value, (low, high) in (("mass (kg)", mass, MASS_KG), ("friction", friction, FRICTION)):
            if not low <= value <= high:
                raise InputError(where, f"{name}, {what}", value, f"a number from {low:g} to {high:g}")
        found[name] = PhysicalParameters(mass, friction)
    if not found:
        raise InputError(where, "", repr(text), FORM)
    return found
