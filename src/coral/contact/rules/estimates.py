"""The default advisor's rule for mass and friction, from the density of the material that a label names."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from coral.advisor.question import Rejection
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.prior_beliefs import DENSITY_KG_M3, FRICTION
from coral.contact.world_model.parameter_estimates import ParameterEstimate, ParameterEstimates

# Mean density, hollow space included (kg/m3), and friction on a table: orders of magnitude only.
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


UNKNOWN = (DENSITY_KG_M3, FRICTION)


def estimate_parameters(facts: SceneFacts, rejections: Sequence[Rejection] = ()) -> ParameterEstimates:
    """Estimate mass as volume times the density for the label; after a refusal, also for unknown labels."""
    found = {}
    for name, item in facts["objects"].items():
        words = f"{item.get('label', '')} {name}".lower().replace("-", " ").replace("_", " ").split()
        named = () if rejections else words
        density, friction = next((MATERIALS[word] for word in named if word in MATERIALS), UNKNOWN)
        mass = density * math.prod(item["size_m"]) * item.get("solid_share", 1.0)
        found[name] = ParameterEstimate(mass_kg=mass, friction_coeff=friction)
    return ParameterEstimates(found)
