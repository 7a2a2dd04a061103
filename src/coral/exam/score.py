"""Score of an answer by its kind of question, from 0 to 1, with the reason in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel

from coral.exam.contact_outcome import score_plan, score_unified
from coral.exam.contact_score import score_correction, score_estimates, score_poses, score_regions
from coral.exam.item import ExamItem
from coral.exam.reef_score import score_centroid, score_waypoint
from coral.exam.word_score import score_mission
from coral.exam.worth import Worth

SCORES: Mapping[str, Callable[[Mapping[str, Any], Mapping[str, Any], Any], Worth]] = {
    "reef-centroid": score_centroid,
    "reef-waypoint": score_waypoint,
    "reef-mission": score_mission,
    "physical-parameters": score_estimates,
    "contact-regions": score_regions,
    "object-poses": score_poses,
    "parameter-repair": score_correction,
    "cost-function": score_plan,
    "cost-repair": score_plan,
    "unified": score_unified,
}
"""Scoring function of each kind of question: (key, facts, answer) to the score."""


def score(item: ExamItem, answer: BaseModel) -> Worth:
    """Score the answer to one question."""
    return SCORES[item.kind](item.key, item.facts, answer)
