"""The content of the pictures as numbers, for advisors without vision, from the robot's own belief alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.survey import Survey
from coral.reef.map.belief import Belief
from coral.reef.world.geometry import Pose, to_robot, to_world

MAX_FRONTIERS = 40


def describe(outlook: Outlook, left: Survey, options: Sequence[dict[str, float]] | None) -> dict[str, Any]:
    """Return the facts of a question in plain JSON, as on arrival; `options` are waypoints, None for choosing dots."""
    belief, arrival, pose = outlook.belief, outlook.arrival, outlook.arrival.pose
    facts: dict[str, Any] = {
        "robot": {"x": belief.pose.x, "y": belief.pose.y, "theta": belief.pose.theta},
        "arrival": {"pose": {"x": pose.x, "y": pose.y, "theta": pose.theta}, "in_s": round(arrival.in_s, 1)},
        "area_m": list(belief.map.size_m),
        "centroids": _centroids(outlook, left),
        "frontiers": _frontiers(left, pose),
    }
    if belief.last_failure is not None:
        facts["failed"] = {"index": belief.last_failure[0], "cause": belief.last_failure[1]}
    if options is not None:
        facts["options"] = list(options)
    return facts


def waypoint_options(
    belief: Belief, left: Survey, pose: Pose, step_m: int, separation_m: float
) -> list[dict[str, float]]:
    """Find whole-metre steps from a pose to reachable water (paper III-C.2), with their path and what they reveal."""
    steps = [
        (f, s)
        for f in range(-step_m, step_m + 1)
        for s in range(-step_m, step_m + 1)
        if math.hypot(f, s) >= separation_m
    ]
    points = np.array([to_world(pose, f, s) for f, s in steps])
    paths = left.field.lengths(points[:, 0], points[:, 1])
    return [
        {"forward_m": f, "left_m": s, "path_m": round(float(path), 2), "unexplored": _unexplored(belief, left, x, y)}
        for (f, s), (x, y), path in zip(steps, points, paths, strict=True)
        if math.isfinite(path) and belief.map.contains(x, y)
    ]


def _centroids(outlook: Outlook, left: Survey) -> list[dict[str, Any]]:
    belief, pose = outlook.belief, outlook.arrival.pose
    trail, cell_m = belief.trajectory, belief.map.cfg.cell_m
    described = []
    for position, t in enumerate(belief.tracker.chain()):
        described.append(
            {
                "index": t.index,
                **_place(pose, t.x, t.y),
                "path_m": _finite(left.path_m(t.x, t.y)),
                "visited": outlook.done(t),
                **({"far": True} if t.far else {}),
                **({"doubtful": True} if t.doubtful and not outlook.last_look else {}),
                "inspected": round(t.inspected, 2),
                "left_m2": None if t.far else round(len(t.left) * cell_m**2, 2),
                "chain_position": position,
                "failed_attempts": belief.failures(t.x, t.y),
                "area_m2": round(t.area_px * cell_m**2, 2),
                "unexplored": _unexplored(belief, left, t.x, t.y),
                "trajectory_m": _finite(float(np.min(np.hypot(trail[:, 0] - t.x, trail[:, 1] - t.y)))),
            }
        )
    return described


def _frontiers(left: Survey, pose: Pose) -> list[dict[str, Any]]:
    return [
        {
            **_place(pose, f.x, f.y),
            "path_m": round(f.path_m, 2),
            "length_m": round(f.length_m, 2),
            "unexplored": round(f.unexplored, 3),
            "reef_m": _finite(f.reef_m),
        }
        for f in left.frontiers[:MAX_FRONTIERS]
    ]


def _place(pose: Pose, x: float, y: float) -> dict[str, float]:
    forward, to_left = to_robot(pose, x, y)
    bearing = math.degrees(math.atan2(to_left, forward))
    return {"forward_m": round(forward, 2), "left_m": round(to_left, 2), "bearing_deg": round(bearing, 1)}


def _unexplored(belief: Belief, left: Survey, x: float, y: float) -> float:
    return round(belief.map.unexplored_share(x, y, left.gain_radius_m), 3)


def _finite(value: float) -> float | None:
    return round(value, 2) if math.isfinite(value) else None
