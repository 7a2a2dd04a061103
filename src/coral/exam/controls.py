"""Advisors without knowledge, as a check of the scores: random valid answers, or always the same answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel

from coral.advisor.question import Rejection
from coral.advisor.rules import RuleAdvisor
from coral.advisor.setting import Rule
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker.pose_question import PosesAnswer
from coral.contact.thinker.unified_question import UnifiedAnswer
from coral.contact.world_model.parameter_correction import ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterBoundsCfg, ParameterEstimates
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.decide.mission_answer import MissionAnswer

Facts = Mapping[str, Any]
STEP_M = 6


class RandomAnswers:
    """Draws valid answers uniformly at random; sizes and masses are uniform in their logarithms.

    Args:
        rng: The random generator.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def centroid(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a dot of the map."""
        return CentroidChoice(selected_centroid_index=self._draw([c["index"] for c in facts["centroids"]]))

    def waypoint(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a waypoint in whole metres."""
        forward, left = (int(v) for v in self._rng.integers(-STEP_M, STEP_M + 1, 2))
        return WaypointChoice(forward_m=forward, left_m=left)

    def mission(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a dot of the map."""
        return MissionAnswer(selected_centroid_index=self._draw([c["index"] for c in facts["centroids"]]))

    def estimates(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw masses and frictions within the bounds."""
        return ParameterEstimates.model_validate(
            {
                name: dict(zip(("mass_kg", "friction_coeff"), self._parameters(item), strict=True))
                for name, item in facts["objects"].items()
            }
        )

    def correction(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw mass and friction of the object in question."""
        name = facts["fitted"]["object"]
        mass, friction = self._parameters(facts["objects"][name])
        return ParametersAnswer.model_validate({"objects": [{"label": name, "mass": mass, "friction": friction}]})

    def poses(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw positions on the table and any rotation about the vertical."""
        found = {}
        for name, item in facts["objects"].items():
            yaw = self._rng.uniform(-math.pi, math.pi)
            x, y = (float(self._rng.uniform(*facts["table"][axis])) for axis in "xy")
            turned = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
            found[name] = {"position": [x, y, item["size_m"][2] / 2], "quaternion": turned}
        return PosesAnswer.model_validate(found)

    def regions(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a point on a face of each object's bounding box, and an approach."""
        name = self._draw(sorted(facts["objects"]))
        item = facts["objects"][name]
        axis, sign = int(self._rng.integers(3)), float(self._rng.choice([-1.0, 1.0]))
        half = np.asarray(item["size_m"]) / 2
        center = self._rng.uniform(-half, half)
        center[axis] = sign * half[axis]
        center += np.asarray(item.get("middle_m", (0.0, 0.0, 0.0)))
        normal = np.zeros(3)
        normal[axis] = sign
        how = self._draw(["push", "press", "pinch"])
        region = {
            "center": center.tolist(),
            "normal": normal.tolist(),
            "extent": 0.01,
            "num_samples": 8,
            "approach": how,
        }
        return RegionsAnswer.model_validate({name: {"regions": [region]}})

    def plan(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a cost of one to three distances between any two points, with any weight and sign."""
        places = ["ee_pos", *(f"{name}_pos" for name in facts["objects"]), *(f"{name}_pos" for name in facts["places"])]
        terms = []
        for _ in range(int(self._rng.integers(1, 4))):
            a, b = self._rng.choice(len(places), 2, replace=False)
            weight = round(float(self._rng.choice([-1, 1]) * math.exp(self._rng.uniform(-1.0, 3.0))), 3)
            terms.append(f"{weight} * np.linalg.norm(self.{places[a]} - self.{places[b]})")
        return PlanAnswer(code=f"def state_cost(self):\n    return {' + '.join(terms)}\n")

    def unified(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Draw a plan, estimates and contact regions together."""
        return _combine_rules(self.plan, self.estimates, self.regions, facts)

    def _parameters(self, item: Facts) -> tuple[float, float]:
        bounds, volume = ParameterBoundsCfg(), math.prod(item["size_m"])
        low = max(bounds.mass_kg[0], bounds.density_kg_m3[0] * volume)
        high = min(bounds.mass_kg[1], bounds.density_kg_m3[1] * volume)
        mass, friction = (
            math.exp(self._rng.uniform(math.log(a), math.log(b))) for a, b in ((low, high), bounds.friction)
        )
        return mass, friction

    def _draw(self, among: Sequence[Any]) -> Any:
        return among[int(self._rng.integers(len(among)))]


class ConstantAnswers:
    """Gives one answer to each kind of question, whatever the facts: the first dot, straight ahead, water's density."""

    def centroid(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Choose the first dot."""
        return CentroidChoice(selected_centroid_index=min(c["index"] for c in facts["centroids"]))

    def waypoint(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Drive straight ahead."""
        return WaypointChoice(forward_m=5, left_m=0)

    def mission(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Choose the first dot."""
        return MissionAnswer(selected_centroid_index=min(c["index"] for c in facts["centroids"]))

    def estimates(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Estimate the density of water and a common friction."""
        return ParameterEstimates.model_validate(
            {
                name: {"mass_kg": 1000.0 * math.prod(item["size_m"]), "friction_coeff": 0.45}
                for name, item in facts["objects"].items()
            }
        )

    def correction(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Keep the belief."""
        name = facts["fitted"]["object"]
        item = facts["objects"][name]
        return ParametersAnswer.model_validate(
            {"objects": [{"label": name, "mass": item["mass_kg"], "friction": item["friction"]}]}
        )

    def poses(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Put every object at its usual pose."""
        return PosesAnswer.model_validate(
            {
                name: {"position": item["usual_pose"][:3], "quaternion": item["usual_pose"][3:]}
                for name, item in facts["objects"].items()
            }
        )

    def regions(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Choose the face of the first object whose normal is its negative x axis."""
        name, item = next(iter(facts["objects"].items()))
        center = np.asarray(item.get("middle_m", (0.0, 0.0, 0.0))) - [
            item["size_m"][0] / 2,
            0.0,
            -0.2 * item["size_m"][2],
        ]
        region = {"center": center.tolist(), "normal": [-1.0, 0.0, 0.0], "approach": "push"}
        return RegionsAnswer.model_validate({name: {"regions": [region]}})

    def plan(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Move the hand to the first object, and the object to the first place, or up."""
        name = next(iter(facts["objects"]))
        goal = (
            f"{next(iter(facts['places']))}_pos" if facts["places"] else f"{name}_init_pos + np.array([0.0, 0.0, 0.1])"
        )
        goal = goal if goal.startswith("np") else f"self.{goal}"
        return PlanAnswer(
            code="def state_cost(self):\n"
            f"    return 5.0 * np.linalg.norm(self.ee_pos - self.{name}_pos)"
            f" + 10.0 * np.linalg.norm(self.{name}_pos - ({goal}))\n"
        )

    def unified(self, facts: Facts, rejections: Sequence[Rejection]) -> BaseModel:
        """Combine the plan, the estimates and the contact regions."""
        return _combine_rules(self.plan, self.estimates, self.regions, facts)


CONTROLS: Mapping[str, str] = {
    "random": "draws a random valid answer",
    "constant": "gives every question of a kind the same answer",
}
"""Names that a bench accepts besides those of advisors, with their help."""


def control(name: str, rng: np.random.Generator) -> RuleAdvisor:
    """Make the advisor of one name in `CONTROLS`."""
    one: RandomAnswers | ConstantAnswers = RandomAnswers(rng) if name == "random" else ConstantAnswers()
    rules: Mapping[str, Rule] = {
        "reef-centroid": one.centroid,
        "reef-waypoint": one.waypoint,
        "reef-mission": one.mission,
        "physical-parameters": one.estimates,
        "contact-regions": one.regions,
        "object-poses": one.poses,
        "parameter-repair": one.correction,
        "cost-function": one.plan,
        "cost-repair": one.plan,
        "unified": one.unified,
    }
    return RuleAdvisor(rules, name=name)


def _combine_rules(plan: Rule, estimates: Rule, regions: Rule, facts: Facts) -> BaseModel:
    parts: list[Callable[..., Any]] = [plan, estimates, regions]
    made, believed, places = (part(facts, ()).model_dump(mode="json") for part in parts)
    return UnifiedAnswer.model_validate({**made, "parameters": believed, "regions": places})
