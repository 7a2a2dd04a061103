"""The content of the pictures as numbers, for advisors without vision, from the robot's own belief alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.reef.belief import Belief
from coral.reef.fleet import Neighbour
from coral.reef.geometry import to_robot, to_world, wrap
from coral.reef.survey import Survey
from coral.reef.topology import Place
from coral.reef.verify import Surroundings, VerifyCfg, reference

MAX_FRONTIERS = 40


def describe(
    belief: Belief,
    left: Survey,
    around: Surroundings,
    cfg: VerifyCfg,
    options: Sequence[dict[str, float]] | None,
    places: Sequence[Place] = (),
) -> dict[str, Any]:
    """Return the facts of a question in plain JSON; points in the robot frame (m forward, m left).

    Args:
        belief: What the robot knows.
        left: What is left to explore.
        around: What the verifiers judge by.
        cfg: The verifiers' thresholds.
        options: Waypoints that may be named; None in centroid selection mode.
        places: The topological memory's graph of what is left; empty without it.
    """
    pose = belief.pose
    facts: dict[str, Any] = {
        "robot": {"x": pose.x, "y": pose.y, "theta": pose.theta},
        "area_m": list(belief.map.size_m),
        "arrival": _arrival(belief),
        "dead_end": around.dead_end,
        "trend_deg": _trend(around, cfg),
        "centroids": _centroids(belief, left),
        "frontiers": _frontiers(belief, left),
    }
    if belief.others:
        facts["others"] = [_other(belief, n) for n in belief.others]
    if places:
        regrets = {place.index: round(place.regret_m, 2) for place in places}
        for centroid in facts["centroids"]:
            centroid["regret_m"] = regrets.get(centroid["index"])
        for frontier in facts["frontiers"]:
            x, y = to_world(pose, frontier["forward_m"], frontier["left_m"])
            near = [p for p in places if p.index is None and math.hypot(p.x - x, p.y - y) < 0.1]
            frontier["regret_m"] = round(near[0].regret_m, 2) if near else None
    if options is not None:
        facts["options"] = list(options)
    return facts


def waypoint_options(belief: Belief, left: Survey, step_m: int, separation_m: float) -> list[dict[str, float]]:
    """Find whole-metre steps to reachable water (paper III-C.2), with their path and the water they would reveal."""
    steps = [
        (f, s)
        for f in range(-step_m, step_m + 1)
        for s in range(-step_m, step_m + 1)
        if math.hypot(f, s) >= separation_m
    ]
    points = np.array([to_world(belief.pose, f, s) for f, s in steps])
    paths = left.paths_m(points[:, 0], points[:, 1])
    return [
        {"forward_m": f, "left_m": s, "path_m": round(float(path), 2), "unexplored": _unexplored(belief, left, x, y)}
        for (f, s), (x, y), path in zip(steps, points, paths, strict=True)
        if math.isfinite(path) and belief.map.contains(x, y) and not belief.taken(x, y)
    ]


def _centroids(belief: Belief, left: Survey) -> list[dict[str, Any]]:
    trail, cell_m = belief.trajectory, belief.map.cfg.cell_m
    described = []
    for position, t in enumerate(belief.tracker.chain()):
        described.append(
            {
                "index": t.index,
                **_place(belief, t.x, t.y),
                "path_m": _finite(left.path_m(t.x, t.y)),
                "visited": t.visited,
                **({"taken": belief.taken(t.x, t.y, t.index)} if belief.others else {}),
                "chain_position": position,
                "failed_attempts": belief.failures(t.x, t.y),
                "area_m2": round(t.area_px * cell_m**2, 2),
                "unexplored": _unexplored(belief, left, t.x, t.y),
                "trajectory_m": _finite(float(np.min(np.hypot(trail[:, 0] - t.x, trail[:, 1] - t.y)))),
            }
        )
    return described


def _frontiers(belief: Belief, left: Survey) -> list[dict[str, Any]]:
    return [
        {
            **_place(belief, f.x, f.y),
            "path_m": round(f.path_m, 2),
            "length_m": round(f.length_m, 2),
            "unexplored": round(f.unexplored, 3),
            "reef_m": _finite(f.reef_m),
        }
        for f in left.frontiers[:MAX_FRONTIERS]
    ]


def _arrival(belief: Belief) -> dict[str, float]:
    """Predict where the robot will be when the answer comes, in its present frame: at its current goal."""
    if belief.goal is None:
        return {"forward_m": 0.0, "left_m": 0.0, "heading_deg": 0.0}
    forward, to_left = to_robot(belief.pose, *belief.goal)
    heading = math.degrees(math.atan2(to_left, forward)) if math.hypot(forward, to_left) > 0.5 else 0.0
    return {"forward_m": round(forward, 2), "left_m": round(to_left, 2), "heading_deg": round(heading, 1)}


def _trend(around: Surroundings, cfg: VerifyCfg) -> float | None:
    """Bearing of the chain's trend (deg, Eq. 7), as the blue line on the map shows it; None when it says nothing."""
    found = reference(around, cfg)
    if found is None or len(around.chain) < cfg.min_centroids:
        return None
    return round(math.degrees(wrap(math.atan2(found[0][1], found[0][0]) - around.pose.theta)), 1)


def _place(belief: Belief, x: float, y: float) -> dict[str, float]:
    forward, to_left = to_robot(belief.pose, x, y)
    bearing = math.degrees(math.atan2(to_left, forward))
    return {"forward_m": round(forward, 2), "left_m": round(to_left, 2), "bearing_deg": round(bearing, 1)}


def _other(belief: Belief, other: Neighbour) -> dict[str, float | None]:
    """Describe another robot and its goal, null if it has none."""
    here = to_robot(belief.pose, other.pose.x, other.pose.y)
    goal = (None, None) if other.goal is None else to_robot(belief.pose, *other.goal)
    names = ("forward_m", "left_m", "goal_forward_m", "goal_left_m")
    return {name: None if value is None else round(value, 2) for name, value in zip(names, (*here, *goal), strict=True)}


def _unexplored(belief: Belief, left: Survey, x: float, y: float) -> float:
    return round(belief.map.unexplored_share(x, y, left.gain_radius_m), 3)


def _finite(value: float) -> float | None:
    return round(value, 2) if math.isfinite(value) else None
