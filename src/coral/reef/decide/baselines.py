"""Baseline deciders: what a user would do without a foundation model (paper IV-C, IV-D, and beyond).

They answer the same questions from the same facts as any advisor, without delay, and use the same controller.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coral.advisor.question import Rejection
from coral.advisor.setting import Rule
from coral.reef.decide.answers import CentroidChoice, MissionAnswer, WaypointChoice, WaypointStep

Fact = Mapping[str, Any]


def _open_dots(facts: Fact, rejections: Sequence[Rejection]) -> list[Fact]:
    """Return the clusters to choose from: those left that were not refused, else those left, else all."""
    refused = {r.details.get("index") for r in rejections}
    left = [c for c in facts["centroids"] if not c["visited"] and c["path_m"] is not None]
    return [c for c in left if c["index"] not in refused] or left or list(facts["centroids"])


def _open_steps(facts: Fact, rejections: Sequence[Rejection]) -> list[Fact]:
    """Return the waypoints that were not refused."""
    refused = {(r.details.get("forward_m"), r.details.get("left_m")) for r in rejections}
    return [o for o in facts["options"] if (o["forward_m"], o["left_m"]) not in refused]


def nearest_centroid(facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
    """Choose the nearest unvisited centroid and ignore the rest of the map: Rule-Based Selection (paper IV-D)."""
    best = min(_open_dots(facts, rejections), key=lambda c: math.hypot(c["forward_m"], c["left_m"]))
    return CentroidChoice(selected_centroid_index=best["index"], reason="the nearest unvisited cluster")


def nearest_frontier(facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
    """Choose the nearest border of the explored water: frontier exploration (Yamauchi 1997)."""
    aims = facts["frontiers"] or [c for c in facts["centroids"] if not c["visited"] and c["path_m"] is not None]
    if not aims:
        return WaypointChoice(forward_m=0, left_m=0, reason="nothing unexplored can be reached")
    aim = min(aims, key=lambda a: a["path_m"])
    return _towards(facts, aim["forward_m"], aim["left_m"], rejections, "the nearest frontier")


def _towards(facts: Fact, forward: float, left: float, rejections: Sequence[Rejection], name: str) -> WaypointChoice:
    """Choose the option with the least path plus 1.5 times its distance to a point in the robot frame."""
    open_ = _open_steps(facts, rejections)
    if not open_:
        return WaypointChoice(forward_m=0, left_m=0, reason="no waypoint can be reached")
    best = min(open_, key=lambda o: o["path_m"] + 1.5 * math.hypot(o["forward_m"] - forward, o["left_m"] - left))
    return WaypointChoice(forward_m=best["forward_m"], left_m=best["left_m"], reason=f"towards {name}")


def first_dot(facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
    """Choose the dot with the smallest label, whatever the map says."""
    return CentroidChoice(selected_centroid_index=min(c["index"] for c in facts["centroids"]), reason="the first")


def straight_ahead(facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
    """Choose the point 5 m ahead, whatever the map says."""
    return WaypointChoice(forward_m=5, left_m=0, reason="straight ahead")


class Chance:
    """Chooses uniformly among the candidates: the baseline that shows what good decisions are worth."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def centroid(self, facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
        """Choose uniformly among the reachable unvisited clusters that have not been refused."""
        chosen = self._draw(_open_dots(facts, rejections))
        return CentroidChoice(selected_centroid_index=chosen["index"], reason="drawn by lot")

    def waypoint(self, facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
        """Choose uniformly among the admissible waypoints that have not been refused."""
        open_ = _open_steps(facts, rejections)
        if not open_:
            return WaypointChoice(forward_m=0, left_m=0, reason="no waypoint can be reached")
        chosen = self._draw(open_)
        return WaypointChoice(forward_m=chosen["forward_m"], left_m=chosen["left_m"], reason="drawn by lot")

    def mission(self, facts: Fact, rejections: Sequence[Rejection]) -> MissionAnswer:
        """Choose uniformly among the clusters that are left, the waypoints and the end, which is one choice in 20."""
        dots = [c for c in facts["centroids"] if not c["visited"] and c["path_m"] is not None]
        if self._rng.random() < 0.05:
            return MissionAnswer(done=True, answer=str(int(self._rng.integers(6))), reason="drawn by lot")
        if dots and self._rng.random() < 0.5:
            return MissionAnswer(selected_centroid_index=self._draw(dots)["index"], reason="drawn by lot")
        if not facts["options"]:
            return MissionAnswer(home=True, reason="no waypoint can be reached")
        step = self._draw(facts["options"])
        waypoint = WaypointStep(forward_m=step["forward_m"], left_m=step["left_m"])
        return MissionAnswer(waypoint=waypoint, reason="drawn by lot")

    def _draw(self, among: Sequence[Fact]) -> Fact:
        return among[int(self._rng.integers(len(among)))]


def baseline_rules(name: str, rng: np.random.Generator | None = None) -> dict[str, Rule]:
    """Return the rules of a baseline: "nearest", "frontier", "constant", or "random", which draws from `rng`."""
    if name == "random":
        chance = Chance(rng or np.random.default_rng(0))
        return {"reef-centroid": chance.centroid, "reef-waypoint": chance.waypoint, "reef-mission": chance.mission}
    if name == "constant":
        return {"reef-centroid": first_dot, "reef-waypoint": straight_ahead}
    return {"reef-centroid": nearest_centroid, "reef-waypoint": nearest_frontier}
