"""The reef's rules for the embedded `heuristic` advisor: the paper's own priority rules, on `facts`.

Avoid what has been visited, prefer what lies near unexplored water, continue away from the trajectory, follow the
chain (paper III-C.1). It is a rule system, not a language or vision model.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from coral.advisor.question import Rejection
from coral.reef.answers import CentroidChoice, WaypointChoice

TURN_M = 1.0
"""A radian of turning is worth this much way (m)."""
UNEXPLORED_M = 3.0
"""Fully unexplored surroundings are worth this much way (m)."""
NEAR_M = 2.0
"""Waypoints nearer than this are reached before the next answer comes."""
REEF_M = 4.0
"""Oysters settle near oysters: frontiers farther than this from the reef pay for the excess."""


def choose_centroid(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> CentroidChoice:
    """Answer a centroid question."""
    refused = {r.details.get("index") for r in rejections}
    fresh = [c for c in facts["centroids"] if not c["visited"] and c["path_m"] is not None]
    open_ = [c for c in fresh if c["index"] not in refused] or fresh or list(facts["centroids"])
    if not open_:
        return CentroidChoice(selected_centroid_index=None, reason="No cluster is on the map.")
    ahead = [c for c in open_ if c["forward_m"] >= 1.0]
    best = min(ahead or open_, key=_centroid_cost)
    why = (f"Cluster {best['index']} is not visited, lies {best['forward_m']:.1f} m ahead and {best['left_m']:+.1f} m to "
           f"the left, {100 * best['unexplored']:.0f} % of its surroundings are unexplored.")
    if not ahead:
        why += " Nothing is left ahead, so the robot turns back for it."
    return CentroidChoice(selected_centroid_index=best["index"], reason=why)


def _centroid_cost(c: Mapping[str, Any]) -> float:
    path = c["path_m"] if c["path_m"] is not None else 100.0
    turn = TURN_M * abs(math.radians(c["bearing_deg"]))
    return float(path + turn - UNEXPLORED_M * c["unexplored"] + 5.0 * c["failed_attempts"])


def choose_waypoint(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> WaypointChoice:
    """Answer a free waypoint question: make for the frontier that is worth its way, or for a cluster left behind."""
    refused = {(r.details.get("forward_m"), r.details.get("left_m")) for r in rejections}
    options = [o for o in facts["options"] if (o["forward_m"], o["left_m"]) not in refused]
    if not options:
        return WaypointChoice(forward_m=0, left_m=0, reason="No waypoint can be reached.")
    aims = [(_frontier_cost(f), f, "unexplored water") for f in facts["frontiers"]]
    aims += [(_centroid_cost(c), c, f"cluster {c['index']}") for c in facts["centroids"]
             if not c["visited"] and c["path_m"] is not None]
    if not aims:
        best = max(options, key=lambda o: (o["unexplored"], -o["path_m"]))
        return WaypointChoice(forward_m=best["forward_m"], left_m=best["left_m"],
                              reason="Most unexplored water in reach.")
    backward = any(r.code in ("behind-robot", "behind-previous", "deviation") for r in rejections)
    if backward:
        aims = [a for a in aims if abs(a[1]["bearing_deg"]) <= 60.0] or aims
    _, aim, name = min(aims, key=lambda a: a[0])

    def detour(o: Mapping[str, Any]) -> float:
        rest = math.hypot(o["forward_m"] - aim["forward_m"], o["left_m"] - aim["left_m"])
        return float(o["path_m"] + 1.5 * rest - 0.5 * o["unexplored"])

    best = min([o for o in options if o["path_m"] >= NEAR_M] or options, key=detour)
    return WaypointChoice(
        forward_m=best["forward_m"], left_m=best["left_m"],
        reason=f"Towards {name}, {aim['path_m']:.1f} m away at a bearing of {aim['bearing_deg']:+.0f}°.")


def _frontier_cost(f: Mapping[str, Any]) -> float:
    reef = max(0.0, f["reef_m"] - REEF_M) if f["reef_m"] is not None else 0.0
    turn = 2.0 * TURN_M * abs(math.radians(f["bearing_deg"]))
    return float(f["path_m"] + turn + reef - 2.0 * UNEXPLORED_M * f["unexplored"])


REEF_RULES = {"reef-centroid": choose_centroid, "reef-waypoint": choose_waypoint}
