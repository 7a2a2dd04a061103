"""Plausible errors of a model that reads the reef's pictures, for the advisor `sloppy`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from coral.advisor.question import Question
from coral.advisor.setting import Answer, Earlier, Mistake

CENTROID, WAYPOINT = "reef-centroid", "reef-waypoint"
STEP_M = 6
"""Longest waypoint step per axis (paper III-C.2)."""
NEIGHBOUR_M = 2.0
"""A dot this much farther from the right one is chosen e times less often, and never beyond three times this."""
MISREAD_M = 3.0
"""A misread place (swapped or rotated) stands for a dot within this distance of it."""
ANGLE_DEG, DISTANCE = 25.0, 0.35
"""Standard deviations of a blurred waypoint: of its angle (deg) and of the logarithm of its distance."""
STALE_S = 10.0
"""Age of the picture that a late answer is about: the paper's median latency."""
TRIES = 8

Turn = Callable[[float, float], tuple[float, float]]
"""Maps (forward, left) to the misread place, in the robot frame (m)."""


def _confuse_dots(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Choose another dot near the right one; nearer dots are more likely."""
    chosen, others = _dots(question, right)
    if chosen is None:
        return None
    distances = np.array([_distance(dot, chosen["forward_m"], chosen["left_m"]) for dot in others])
    weights = np.exp(-distances / NEIGHBOUR_M) * (distances <= 3.0 * NEIGHBOUR_M)
    if not weights.sum() > 0.0:
        return None
    return _dot(right, others[int(rng.choice(len(others), p=weights / weights.sum()))])


def _blur(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Blur the waypoint in angle and distance."""
    distance = math.hypot(right["forward_m"], right["left_m"])
    if not distance:
        return None
    for _ in range(TRIES):  # rounding to whole metres hides small errors
        angle = math.atan2(right["left_m"], right["forward_m"]) + math.radians(ANGLE_DEG) * rng.standard_normal()
        reach = distance * math.exp(DISTANCE * rng.standard_normal())
        wrong = _step(right, reach * math.cos(angle), reach * math.sin(angle))
        if not _same(wrong, right):
            return wrong
    return None


def _mirror(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Swap left and right."""
    return _misread(question, right, lambda forward, left: (forward, -left))


def _rotate(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Read the map as if it were rotated by 90 degrees, to either side."""
    side = 1.0 if rng.random() < 0.5 else -1.0
    return _misread(question, right, lambda forward, left: (-side * left, side * forward))


def _answer_late(
    question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator
) -> Answer | None:
    """Repeat the right answer to the last question of this kind that is at least ten seconds old."""
    old = [one for one in earlier if question.asked_at_s - one.at_s >= STALE_S - 1e-9]
    if not old or _same(old[-1].answer, right):
        return None
    return {**old[-1].answer, "reason": ""}


REEF_MISTAKES = (
    Mistake(
        name="dots",
        what="a dot is confused with one near it",
        found_in="BlindTest, arXiv:2407.06581: models fail to tell which of several close marks is meant, and where "
        "precise positions count",
        questions=(CENTROID,),
        err=_confuse_dots,
    ),
    Mistake(
        name="blurred",
        what="a waypoint is off in angle (25°) and distance (a factor of 1.4), one standard deviation",
        found_in="Q-Spatial Bench, arXiv:2409.09788: distances are hard to tell for all models that were tried",
        questions=(WAYPOINT,),
        err=_blur,
    ),
    Mistake(
        name="mirrored",
        what="left and right are swapped",
        found_in="What's “up” with vision-language models?, arXiv:2310.19785: models fail on basic spatial relations, "
        "left of and right of among them",
        questions=(CENTROID, WAYPOINT),
        err=_mirror,
    ),
    Mistake(
        name="rotated",
        what="the map is read as though it were turned by a quarter",
        found_in="m2sv, arXiv:2601.19099: overhead maps are aligned badly with the view from the ground; COMFORT, "
        "arXiv:2410.17385: frames of reference are confused",
        questions=(CENTROID, WAYPOINT),
        err=_rotate,
    ),
    Mistake(
        name="stale",
        what="an answer that was right 10 s ago or more, at the last question of its kind",
        found_in="",
        questions=(CENTROID, WAYPOINT),
        err=_answer_late,
    ),
)
"""Mistakes that can be named after `sloppy:`."""


def _misread(question: Question[Any], right: Answer, turn: Turn) -> Answer | None:
    """Return the answer to a misread picture; None if it means a dot and no dot lies near the misread place."""
    if question.kind == WAYPOINT:
        wrong = _step(right, *turn(float(right["forward_m"]), float(right["left_m"])))
        return None if _same(wrong, right) else wrong
    chosen, others = _dots(question, right)
    if chosen is None or not others:
        return None
    place = turn(chosen["forward_m"], chosen["left_m"])
    nearest = min(others, key=lambda dot: _distance(dot, *place))
    return _dot(right, nearest) if _distance(nearest, *place) <= MISREAD_M else None


def _dots(question: Question[Any], right: Answer) -> tuple[Mapping[str, Any] | None, list[Mapping[str, Any]]]:
    """Return the chosen dot and the others; None for a label that is not on the map."""
    dots = question.facts["centroids"]
    chosen = next((dot for dot in dots if dot["index"] == right["selected_centroid_index"]), None)
    return chosen, [dot for dot in dots if dot is not chosen]


def _distance(dot: Mapping[str, Any], forward: float, left: float) -> float:
    return math.hypot(dot["forward_m"] - forward, dot["left_m"] - left)


def _dot(right: Answer, dot: Mapping[str, Any]) -> Answer:
    return {**right, "selected_centroid_index": dot["index"], "then": [], "reason": ""}


def _step(right: Answer, forward: float, left: float) -> Answer:
    """A waypoint in whole metres within the longest step."""
    steps = [int(np.clip(round(value), -STEP_M, STEP_M)) for value in (forward, left)]
    rest = {"explore_rest": False} if right.get("explore_rest") else {}
    return {**right, **rest, "forward_m": steps[0], "left_m": steps[1], "then": [], "reason": ""}


def _same(a: Answer, b: Answer) -> bool:
    """Whether two answers say the same, whatever their reasons and what they would do next."""
    beside = {"then": [], "reason": "", "explore_rest": False}
    return {**a, **beside} == {**b, **beside}
