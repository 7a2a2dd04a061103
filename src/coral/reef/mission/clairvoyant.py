"""A control that knows where the clusters are: what knowing more than the map is worth, and what a check does to it.

It is no method and no model. It sees no picture; of the truth it knows the clusters' centres and nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Rejection
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.answers import CentroidChoice, Expectation, WaypointChoice, WaypointStep
from coral.reef.vehicle.delays import delays_from
from coral.reef.world.geometry import Pose, to_robot
from coral.reef.world.world import ReefWorld

NAME = "clairvoyant"
SAME_M = 1.5
"""A dot this near to a true cluster stands for it."""
SPEED_M_S, YAW_RATE_RAD_S = 0.5, 0.6
STEP_M = 6
MOST = 9
"""Clusters that a tour is planned over."""

Fact = Mapping[str, Any]


class Clairvoyant:
    """Goes to the true clusters in the order in which they wait least, by straight ways."""

    def __init__(self, clusters: NDArray[np.float64]) -> None:
        """Set the true centres of the clusters (m). Shape=(C, 2)."""
        self._clusters = clusters
        self._done: set[int] = set()

    def centroid(self, facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
        """Choose the dot of the first cluster, or a waypoint towards it where it has none."""
        refused = {r.details.get("index") for r in rejections}
        aim, dots = self._first(facts), _open(facts, refused)
        if aim is None:
            index = min(dots, key=lambda c: math.hypot(c["forward_m"], c["left_m"]), default={"index": None})["index"]
            return CentroidChoice(selected_centroid_index=index, end_survey=index is None, reason=NAME)
        dot = _dot_at(dots, aim)
        if dot is not None:
            return CentroidChoice(selected_centroid_index=dot["index"], reason=NAME)
        return CentroidChoice(
            selected_centroid_index=None, waypoint=_step(aim, rejections), expect=_expected(aim), reason=NAME
        )

    def waypoint(self, facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
        """Choose a waypoint towards the first cluster, or its dot."""
        aim = self._first(facts)
        if aim is None:
            option = max(facts["options"], key=lambda o: (o["unexplored"], -o["path_m"]), default=None)
            ahead, aside = (0, 0) if option is None else (option["forward_m"], option["left_m"])
            return WaypointChoice(forward_m=ahead, left_m=aside, reason=NAME)
        dot = _dot_at(_open(facts, {r.details.get("index") for r in rejections}), aim)
        step = _step(aim, rejections)
        return WaypointChoice(
            forward_m=step.forward_m,
            left_m=step.left_m,
            dot=None if dot is None else dot["index"],
            expect=None if dot is not None else _expected(aim),
            reason=NAME,
        )

    def _first(self, facts: Fact) -> tuple[float, float] | None:
        """Return the cluster to go to (m forward, m left); None when all are done by the robot's own map."""
        pose = Pose(**facts["arrival"]["pose"])
        at = np.array([to_robot(pose, x, y) for x, y in self._clusters.tolist()]).reshape(-1, 2)
        for dot in facts["centroids"]:
            away = np.hypot(at[:, 0] - dot["forward_m"], at[:, 1] - dot["left_m"])
            if dot["visited"]:
                self._done |= set(np.flatnonzero(away <= SAME_M).tolist())
        left = [k for k in range(len(at)) if k not in self._done]
        left = sorted(left, key=lambda k: math.hypot(*at[k]))[:MOST]
        if not left:
            return None
        points = at[left]
        between = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)) / SPEED_M_S
        turn = np.abs(np.arctan2(points[:, 1], points[:, 0])) / YAW_RATE_RAD_S
        total = np.hypot(*points.T) / SPEED_M_S + turn + delays_from(between, np.ones(len(left)))
        forward, side = points[int(np.argmin(total))].tolist()
        return forward, side


def clairvoyant(world: ReefWorld) -> RuleAdvisor:
    """Make the control for one world."""
    middles = [np.mean([(oyster.x, oyster.y) for oyster in cluster.oysters], axis=0) for cluster in world.clusters]
    one = Clairvoyant(np.array(middles))
    return RuleAdvisor({"reef-centroid": one.centroid, "reef-waypoint": one.waypoint}, name=NAME)


def _open(facts: Fact, refused: set[Any]) -> list[Fact]:
    return [c for c in facts["centroids"] if not c["visited"] and c["index"] not in refused]


def _dot_at(dots: Sequence[Fact], aim: tuple[float, float]) -> Fact | None:
    near = [(math.dist((c["forward_m"], c["left_m"]), aim), c["index"], c) for c in dots]
    return min((n for n in near if n[0] <= SAME_M), default=(0.0, 0, None), key=lambda n: n[:2])[2]


def _expected(aim: tuple[float, float]) -> Expectation:
    return Expectation(what="a cluster", forward_m=round(aim[0], 2), left_m=round(aim[1], 2), sure=1.0)


def _step(aim: tuple[float, float], rejections: Sequence[Rejection]) -> WaypointStep:
    """Return a whole-metre step towards a place, shorter after each refusal."""
    scale = min(1.0, STEP_M / max(abs(aim[0]), abs(aim[1]), 1e-6)) * 0.75 ** len(rejections)
    return WaypointStep(forward_m=round(aim[0] * scale), left_m=round(aim[1] * scale))
