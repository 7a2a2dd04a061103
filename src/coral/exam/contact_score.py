"""Scores of answers about a contact scene against the truth: parameters, poses, contact regions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.region_validation import verify_regions
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.geometry import conjugate, multiply, rotation_of
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.pose_question import PosesAnswer
from coral.contact.world_model.parameter_correction import ParametersAnswer, verify_parameters
from coral.contact.world_model.parameter_estimates import ParameterEstimates, verify_estimates
from coral.exam.contact_touch import fits
from coral.exam.worth import Worth, share_left

Facts = Mapping[str, Any]
MASS_FACTOR, FRICTION_FACTOR = 4.0, 2.0
"""An estimate that is off by this factor scores 0: materials differ by more, the tasks' ranges by less."""
MASS_SHARE = 0.75
"""Weight of the mass in the score. Most materials have similar friction, so estimating it well proves little."""
PLACE_M, TURN_RAD = 0.03, math.radians(20.0)
"""A pose that is off by this much scores 0: a grasp tolerates less."""
PLACE_SHARE = 0.6
"""Weight of the place in the score of a pose."""

_HALF = math.sqrt(0.5)
_BOX = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
_SQUARE = (
    *_BOX,
    (_HALF, 0.0, 0.0, _HALF),
    (_HALF, 0.0, 0.0, -_HALF),
    (0.0, _HALF, _HALF, 0.0),
    (0.0, _HALF, -_HALF, 0.0),
)
SPINS = {"box": _BOX, "square-box": _SQUARE, "cube": _SQUARE}
"""Quaternions of the rotations that leave an object looking the same; a cube needs only those about its vertical."""


def score_estimates(key: Facts, facts: Facts, answer: ParameterEstimates) -> Worth:
    """Score masses and frictions by the logarithms of their errors."""
    refusal = verify_estimates(answer, {name: item["size_m"] for name, item in facts["objects"].items()})
    if refusal is not None:
        return Worth(0.0, f"refused: {refusal.code}")
    scores, words = [], []
    for name, true in key["parameters"].items():
        one = answer.root[name]
        mass, friction = _log_error(one.mass_kg, true["mass_kg"]), _log_error(one.friction_coeff, true["friction"])
        scores.append(
            MASS_SHARE * share_left(mass, math.log(MASS_FACTOR))
            + (1.0 - MASS_SHARE) * share_left(friction, math.log(FRICTION_FACTOR))
        )
        words.append(f"{name}: mass off by a factor of {math.exp(mass):.1f}, friction {math.exp(friction):.1f}")
    return Worth(float(np.mean(scores)), "; ".join(words))


def score_correction(key: Facts, facts: Facts, answer: ParametersAnswer) -> Worth:
    """Score a correction by the share of the belief's error that it removes; keeping the belief scores 0."""
    believed = ParameterEstimates.model_validate(
        {
            name: {"mass_kg": item["mass_kg"], "friction_coeff": item["friction"]}
            for name, item in facts["objects"].items()
        }
    ).physical()
    refusal = verify_parameters(answer, believed)
    if refusal is not None:
        return Worth(0.0, f"refused: {refusal.code}")
    name, true = key["object"], key["parameters"]
    after, before = answer.physical(believed)[name], believed[name]
    errors = [_belief_error(one, true) for one in (before, after)]
    return Worth(share_left(errors[1], errors[0]), f"error {errors[1]:.2f}, believed before {errors[0]:.2f}")


def score_poses(key: Facts, facts: Facts, answer: PosesAnswer) -> Worth:
    """Score poses by distance and angle, the angle modulo the object's symmetry."""
    scores, words = [], []
    for name, true in key["poses"].items():
        one = answer.root.get(name)
        norm = 0.0 if one is None else float(np.linalg.norm(one.quaternion))
        if one is None or not norm:
            scores.append(0.0)
            words.append(f"{name}: no pose")
            continue
        off = math.dist(one.position, true["position"])
        angle = _angle(np.array(one.quaternion) / norm, np.array(true["quaternion"]), true["symmetry"])
        turned = share_left(angle, TURN_RAD) * (off < PLACE_M)
        scores.append(PLACE_SHARE * share_left(off, PLACE_M) + (1.0 - PLACE_SHARE) * turned)
        words.append(f"{name}: off by {100 * off:.1f} cm and {math.degrees(angle):.0f}°")
    return Worth(float(np.mean(scores)), "; ".join(words))


def score_regions(key: Facts, facts: Facts, answer: RegionsAnswer) -> Worth:
    """Score contact regions: each must pass the verifier and lie on the side that the task wants."""
    scene = cast(SceneFacts, facts)
    refusal = verify_regions(answer, scene, facts["stages"])
    if refusal is not None:
        return Worth(0.0, f"refused: {refusal.code}")
    right = [
        any(
            fits(region, name, touch, facts["objects"][name]["pose"], facts["objects"][name]["size_m"])
            for touch in key["touches"]
        )
        for name, region in answer.each()
    ]
    return Worth(sum(right) / len(right), f"{sum(right)} of {len(right)} places on the right side")


def _belief_error(believed: PhysicalParameters, true: Mapping[str, float]) -> float:
    """Compute the error of a belief in mass, friction and their product, which is all that a slow push reveals."""
    logs = [math.log(believed.mass_kg / true["mass_kg"]), math.log(believed.friction / true["friction"])]
    return abs(logs[0]) + abs(logs[1]) + abs(logs[0] + logs[1])


def _log_error(value: float, true: float) -> float:
    return abs(math.log(value / true)) if value > 0.0 and math.isfinite(value) else math.inf


def _angle(one: NDArray[np.float64], other: NDArray[np.float64], symmetry: str) -> float:
    """Compute the angle (rad) between two orientations, the smallest over the object's symmetry."""
    if symmetry == "sphere":
        return 0.0
    if symmetry == "cylinder":
        return math.acos(min(1.0, abs(float(rotation_of(one)[:, 2] @ rotation_of(other)[:, 2]))))
    turned = multiply(conjugate(other), one)
    spins = np.array(SPINS[symmetry]) if symmetry in SPINS else np.array([[1.0, 0.0, 0.0, 0.0]])
    return 2.0 * math.acos(min(1.0, float(np.abs(spins @ turned).max())))
