"""Scores of reef answers by the time that they lose against the best answer, on the true map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coral.exam.reef_regret import THINKING_S
from coral.exam.worth import Worth, share_left
from coral.reef.decide.answers import CentroidChoice, WaypointChoice


def score_centroid(key: Mapping[str, Any], facts: Mapping[str, Any], answer: CentroidChoice) -> Worth:
    """Score the choice of a dot."""
    return _score(key["seconds"], str(answer.selected_centroid_index))


def score_waypoint(key: Mapping[str, Any], facts: Mapping[str, Any], answer: WaypointChoice) -> Worth:
    """Score the choice of a waypoint."""
    return _score(key["seconds"], f"{answer.forward_m},{answer.left_m}")


def _score(seconds: Mapping[str, float | str], answer: str) -> Worth:
    """Score a choice: 0 if it loses as much time as another question costs, or if it is refused."""
    cost = seconds.get(answer, "no such dot, or out of reach")
    if isinstance(cost, str):
        return Worth(0.0, f"refused: {cost}")
    lost = cost - min(value for value in seconds.values() if not isinstance(value, str))
    return Worth(share_left(lost, THINKING_S), f"loses {lost:.1f} s")
