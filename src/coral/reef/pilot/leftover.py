"""What a survey leaves undone, by the robot's own map: the clusters that are not inspected, and why."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from coral.reef.map.belief import Belief
from coral.reef.map.chain import Track


def what_is_left(belief: Belief) -> list[dict[str, Any]]:
    """Return label, place (m), inspected share and reason of every known cluster that is not finished."""
    return [
        {
            "index": track.index,
            "x": round(track.x, 3),
            "y": round(track.y, 3),
            "inspected": round(track.inspected, 3),
            "why": why_left(belief, track),
        }
        for track in belief.tracks
        if not track.visited
    ]


def chain_of(belief: Belief, closed: Collection[int] = ()) -> list[dict[str, Any]]:
    """Return the chain of clusters as events tell it: label, place (m), whether it is done, inspected share."""
    return [
        {
            "index": track.index,
            "x": round(track.x, 3),
            "y": round(track.y, 3),
            "visited": track.visited,
            **({"done_on_arrival": True} if track.index in closed else {}),
            "inspected": round(track.inspected, 3),
        }
        for track in belief.tracker.chain()
    ]


def why_left(belief: Belief, track: Track) -> str:
    """Say why a cluster has not been finished."""
    failed = belief.failures(track.x, track.y)
    if failed >= belief.cfg.max_attempts:
        return f"given up after {failed} goals that failed"
    if track.index == belief.goal_index:
        return "on the way there"
    if track.far:
        return "seen from afar only"
    return "begun" if track.inspected > 0.0 else "not reached yet"
