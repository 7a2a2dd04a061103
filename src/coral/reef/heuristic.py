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
"""Waypoints nearer than this to where the robot is going anyway are reached before the answer comes."""
BACK_DEG, ASIDE_DEG = 100.0, 50.0
"""Waypoints farther off the heading, or off the chain's trend, lead back or away from the reef."""
SEEN_M = 2.5
"""Clusters nearer than this to where the robot is going anyway are visited before the answer comes."""
REGRET = 0.5
"""Worth of a metre by which a choice lengthens the tour of all that is left (topological memory)."""
REEF_M = 4.0
"""Oysters settle near oysters: frontiers farther than this from the reef pay for the excess."""
OTHERS = 1.0
"""Worth of a metre by which another robot, or its goal, is nearer: what lies on its way is left to it."""

Fact = Mapping[str, Any]


def choose_centroid(facts: Fact, rejections: Sequence[Rejection]) -> CentroidChoice:
    """Answer a centroid question."""
    refused = {r.details.get("index") for r in rejections}
    fresh = [c for c in facts["centroids"] if not c["visited"] and c["path_m"] is not None]
    later = [c for c in fresh if _from_arrival(facts, c)[0] > SEEN_M] or fresh
    later = [c for c in later if not c.get("taken")] or later
    open_ = [c for c in later if c["index"] not in refused] or later or list(facts["centroids"])
    if not open_:
        return CentroidChoice(selected_centroid_index=None, reason="No cluster is on the map.")
    ahead = [c for c in open_ if c["forward_m"] >= 1.0]
    best = min(ahead or open_, key=lambda c: _centroid_cost(facts, c))
    why = (
        f"Cluster {best['index']} is not visited, lies {best['forward_m']:.1f} m ahead and {best['left_m']:+.1f} m "
        f"to the left, {100 * best['unexplored']:.0f} % of its surroundings are unexplored."
    )
    if not ahead:
        why += " Nothing is left ahead, so the robot turns back for it."
    return CentroidChoice(selected_centroid_index=best["index"], reason=why)


def choose_waypoint(facts: Fact, rejections: Sequence[Rejection]) -> WaypointChoice:
    """Answer a free waypoint question: the frontier that is worth its path, or a cluster left behind."""
    refused = {(r.details.get("forward_m"), r.details.get("left_m")) for r in rejections}
    options = [o for o in facts["options"] if (o["forward_m"], o["left_m"]) not in refused]
    if not options:
        return WaypointChoice(forward_m=0, left_m=0, reason="No waypoint can be reached.")
    aims = [(_frontier_cost(facts, f), f, "unexplored water") for f in facts["frontiers"]]
    aims += [
        (_centroid_cost(facts, c), c, f"cluster {c['index']}")
        for c in facts["centroids"]
        if not c["visited"] and not c.get("taken") and c["path_m"] is not None
    ]
    if not aims:
        best = max(options, key=lambda o: (o["unexplored"], -o["path_m"]))
        return WaypointChoice(
            forward_m=best["forward_m"], left_m=best["left_m"], reason="Most unexplored water in reach."
        )
    _, aim, name = min(aims, key=lambda a: a[0])

    def detour(o: Fact) -> float:
        rest = math.hypot(o["forward_m"] - aim["forward_m"], o["left_m"] - aim["left_m"])
        return float(o["path_m"] + 1.5 * rest - 0.5 * o["unexplored"])

    far = [o for o in options if _from_arrival(facts, o)[0] >= NEAR_M] or options
    best = min([o for o in far if facts["dead_end"] or _leads_on(facts, o)] or far, key=detour)
    return WaypointChoice(
        forward_m=best["forward_m"],
        left_m=best["left_m"],
        reason=f"Towards {name}, {aim['path_m']:.1f} m away at a bearing of {aim['bearing_deg']:+.0f}°.",
    )


def _leads_on(facts: Fact, point: Fact) -> bool:
    """Check that a point lies neither back nor off the chain's trend, seen from where the robot will be."""
    there, trend = facts["arrival"], facts["trend_deg"]
    if _from_arrival(facts, point)[1] > math.radians(BACK_DEG):
        return False
    if trend is None:
        return True
    way = math.atan2(point["left_m"] - there["left_m"], point["forward_m"] - there["forward_m"])
    return abs(math.remainder(way - math.radians(trend), 2 * math.pi)) <= math.radians(ASIDE_DEG)


def _from_arrival(facts: Fact, point: Fact) -> tuple[float, float]:
    """Return distance (m) and unsigned bearing (rad) of a point from where the robot will be when the answer comes."""
    there = facts["arrival"]
    dx, dy = point["forward_m"] - there["forward_m"], point["left_m"] - there["left_m"]
    bearing = math.atan2(dy, dx) - math.radians(there["heading_deg"])
    return math.hypot(dx, dy), abs(math.remainder(bearing, 2 * math.pi))


def _centroid_cost(facts: Fact, c: Fact) -> float:
    path = c["path_m"] if c["path_m"] is not None else 100.0
    turn = TURN_M * _from_arrival(facts, c)[1]
    regret = REGRET * (c.get("regret_m") or 0.0)
    others = OTHERS * _nearer_to_others(facts, c)
    return float(path + turn + regret + others - UNEXPLORED_M * c["unexplored"] + 5.0 * c["failed_attempts"])


def _frontier_cost(facts: Fact, f: Fact) -> float:
    reef = max(0.0, f["reef_m"] - REEF_M) if f["reef_m"] is not None else 0.0
    turn = 2.0 * TURN_M * _from_arrival(facts, f)[1]
    regret = REGRET * (f.get("regret_m") or 0.0)
    others = OTHERS * _nearer_to_others(facts, f)
    return float(f["path_m"] + turn + regret + others + 2.0 * reef - 4.0 * UNEXPLORED_M * f["unexplored"])


def _nearer_to_others(facts: Fact, point: Fact) -> float:
    """Return how much nearer (m) another robot or its goal is to a point than this robot and its own; 0 if none is."""
    others = facts.get("others", ())
    if not others:
        return 0.0
    own = min(math.hypot(point["forward_m"], point["left_m"]), _from_arrival(facts, point)[0])
    places = [(o[f"{of}forward_m"], o[f"{of}left_m"]) for o in others for of in ("", "goal_")]
    nearest = min(math.hypot(point["forward_m"] - x, point["left_m"] - y) for x, y in places if x is not None)
    return max(0.0, own - nearest)


REEF_RULES = {"reef-centroid": choose_centroid, "reef-waypoint": choose_waypoint}
