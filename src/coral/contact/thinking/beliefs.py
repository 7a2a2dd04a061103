"""Mass and friction, which no camera shows: estimated by the advisor from what the objects are (section 3.1, A.7)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ConfigDict, RootModel

from coral.advisor.question import Rejection
from coral.config import Positive
from coral.contact.draw import Physical


class Estimate(BaseModel):
    """One object's parameters."""

    model_config = ConfigDict(allow_inf_nan=True)
    mass_kg: float
    friction_coeff: float


class Estimates(RootModel[dict[str, Estimate]]):
    """The completed table of the paper's A.7, by the objects' names."""

    def physical(self) -> dict[str, Physical]:
        """As beliefs of the planning world."""
        return {name: Physical(mass_kg=one.mass_kg, friction=one.friction_coeff) for name, one in self.root.items()}


@dataclass(frozen=True, kw_only=True)
class BeliefCfg:
    """What is possible of something that a hand can move.

    Args:
        mass_kg: Bounds; those of the task format.
        friction: Bounds; those of the task format.
        density_kg_m3: Bounds on mass over the volume of the bounding box: above air-filled foam, below lead.
    """

    mass_kg: tuple[Positive, Positive] = (0.005, 20.0)
    friction: tuple[Positive, Positive] = (0.02, 2.0)
    density_kg_m3: tuple[Positive, Positive] = (5.0, 12_000.0)


def verify_estimates(
    answer: Estimates, sizes: Mapping[str, Sequence[float]], cfg: BeliefCfg | None = None
) -> Rejection | None:
    """Why estimates cannot be believed, or None.

    Args:
        answer: The estimates.
        sizes: Full extents (m) of every object that moves.
        cfg: Bounds.
    """
    cfg = cfg or BeliefCfg()
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
            ("mass_kg", one.mass_kg, cfg.mass_kg, " kg"),
            ("friction_coeff", one.friction_coeff, cfg.friction, ""),
        ):
            if not (math.isfinite(value) and low <= value <= high):
                return Rejection(
                    code="bounds",
                    reason=f"{field} of {name} is {value:g}; something that this hand can "
                    f"move lies between {low:g} and {high:g}{unit}",
                    details={"object": name},
                )
        low, high = cfg.density_kg_m3
        if not low <= one.mass_kg / volume <= high:
            sides = " x ".join(f"{100 * side:.1f}" for side in sizes[name])
            return Rejection(
                code="density",
                reason=f"{one.mass_kg:g} kg in {sides} cm would be "
                f"{one.mass_kg / volume:.3g} kg/m3 for {name}; materials lie between {low:g} and {high:g}",
                details={"object": name},
            )
    return None


# Mean density of a thing called so, air inside counted (kg/m3), and friction on a table. Handbook orders of magnitude.
MATERIALS: Mapping[str, tuple[float, float]] = {
    "foam": (40, 0.6),
    "cork": (200, 0.5),
    "cardboard": (250, 0.5),
    "paper": (600, 0.45),
    "carton": (500, 0.5),
    "plastic": (400, 0.4),
    "bottle": (600, 0.4),
    "cutting": (700, 0.5),
    "wooden": (650, 0.5),
    "wood": (650, 0.5),
    "board": (700, 0.5),
    "book": (800, 0.45),
    "rubber": (1100, 0.9),
    "mug": (700, 0.45),
    "cup": (400, 0.45),
    "can": (1000, 0.45),
    "tin": (1000, 0.4),
    "brick": (1900, 0.6),
    "stone": (2500, 0.6),
    "glass": (1200, 0.4),
    "ceramic": (1500, 0.45),
    "aluminium": (2700, 0.45),
    "steel": (7000, 0.45),
    "metal": (5000, 0.45),
    "box": (300, 0.5),
    "block": (650, 0.5),
    "bag": (600, 0.6),
}
UNKNOWN = (500.0, 0.5)


def estimate(facts: Mapping[str, Any], rejections: Sequence[Rejection] = ()) -> Estimates:
    """The heuristic's answer: volume times the density of what the label names, within what the task file states.

    Refused estimates are drawn to the middle of what the task file states.
    """
    found = {}
    for name, item in facts["objects"].items():
        words = f"{item.get('label', '')} {name}".lower().replace("-", " ").split()
        density, friction = next((MATERIALS[word] for word in words if word in MATERIALS), UNKNOWN)
        mass = density * math.prod(item["size_m"]) * item.get("solid_share", 1.0)
        ranges = item.get("stated_mass_kg", (mass, mass)), item.get("stated_friction", (friction, friction))
        if rejections:
            mass, friction = (sum(ends) / 2 for ends in ranges)
        mass, friction = (
            min(max(value, low), high) for value, (low, high) in zip((mass, friction), ranges, strict=True)
        )
        found[name] = Estimate(mass_kg=mass, friction_coeff=friction)
    return Estimates(found)


def belief_prompt(facts: Mapping[str, Any]) -> dict[str, Any]:
    """What the template "physical-parameters" shows: the paper's table, to be completed."""
    return {
        "task": facts["instruction"],
        "objects": {
            name: {
                "label": item["label"],
                "pose_estimated": item["pose"],
                "size_m": item["size_m"],
                "mass_kg": None,
                "friction_coeff": None,
            }
            for name, item in facts["objects"].items()
        },
    }
