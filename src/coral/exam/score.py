"""Score of an answer by its kind of question, from 0 to 1, with the reason in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel

from coral.exam.contact_outcome import LIMIT_S, score_plan, score_unified
from coral.exam.contact_score import (
    FRICTION_FACTOR,
    MASS_FACTOR,
    MASS_SHARE,
    PLACE_M,
    PLACE_SHARE,
    TURN_RAD,
    score_correction,
    score_estimates,
    score_poses,
    score_regions,
)
from coral.exam.item import ExamItem
from coral.exam.reef_regret import THINKING_S
from coral.exam.reef_score import score_centroid, score_waypoint
from coral.exam.word_score import MARKS, NEXT, SKIP, score_mission
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
WORTH: Mapping[str, str] = {
    "reef-centroid": "1 for the dot from which everything is inspected soonest, by the true map; 0 for one that loses "
    f"{THINKING_S:g} s, the time of another question, or that the verifiers refuse.",
    "reef-waypoint": "The same for a waypoint. At one reached before the next answer can come, the robot waits.",
    "reef-mission": f"{NEXT:g} for a next dot that an oracle would choose, {SKIP:g} for what is ruled out, {MARKS:g} "
    "for marks that name things; where nothing else is asked, all for the marks.",
    "physical-parameters": f"By the logarithm of the error: 0 from a factor of {MASS_FACTOR:g} in mass and of "
    f"{FRICTION_FACTOR:g} in friction on; mass counts {MASS_SHARE:.0%}.",
    "contact-regions": "Share of the named places on the side that the task wants touched; 0 if the verifier refuses "
    "one: off the surface, or out of reach.",
    "object-poses": f"{PLACE_SHARE:g} for the place, within {100 * PLACE_M:g} cm, and if so the rest for the turn, "
    f"within {math.degrees(TURN_RAD):.0f}°, modulo the object's symmetry.",
    "parameter-repair": "Share of the error in a wrong belief that is gone; keeping the belief is worth nothing.",
    "cost-function": f"1 if the plan succeeds within {LIMIT_S:g} s in one episode with a free-flying hand, else 0. "
    "Places to touch are given.",
    "cost-repair": "The same, from where a bad plan had got stuck; the hand begins anew.",
    "unified": "Half for the outcome of its plan with its own beliefs and places, a quarter each for both.",
}
"""What an answer of each kind is worth, in words."""


def score(item: ExamItem, answer: BaseModel) -> Worth:
    """Score the answer to one question."""
    return SCORES[item.kind](item.key, item.facts, answer)
