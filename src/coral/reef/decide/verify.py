"""Formal checks of a chosen waypoint: backward (Eqs. 4-6) and deviation (Eqs. 7-8), with reasons (paper III-D)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from coral.advisor.question import Rejection
from coral.reef.world.geometry import Pose, to_robot

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class VerifyCfg:
    """Thresholds. The paper names them but gives no values; the reasons stand beside each."""

    enabled: bool = True
    """False is the ablation "w/o self-verification": violations are counted, not rejected."""
    by: Literal["regret", "angles"] = "regret"
    """What is refused: choices whose predicted tour is much worse than the best one (beyond the paper, its future
    work), or those that violate the paper's fixed angles (Eqs. 4-8)."""
    theta_back_deg: float = 120.0
    """BehindRobot (Eq. 4). A prong 2.5 m aside, overshot by 1 m, lies at 112°; it must pass."""
    theta_behind_deg: float = 40.0
    """BehindPrev (Eq. 5). An arm of a K may fold back by 45°; it must pass."""
    exempt_distance_m: float = 5.0
    """d_exempt (Eq. 5): points this far from the previous target pass. Twice D_trig."""
    theta_dev_deg: float = 60.0
    """IsDeviated (Eq. 8). Half of the camera's field of view: what the robot would look at."""
    forward_m: float = 1.0
    """d_fwd: smallest forward projection of the reference centroid; equals d_min of Alg. 2."""
    lateral_m: float = 3.0
    """d_lat: largest lateral offset of the reference centroid; half of the longest waypoint step."""
    min_centroids: int = 3
    """Deviation is checked once the chain has this many centroids ("sufficient map information")."""
    coincide_m: float = 0.5
    """A waypoint this close to the reference centroid is not a deviation."""


def stated_limits(cfg: VerifyCfg) -> dict[str, float]:
    """Return the limits of the fixed angles as a question states them, for facts."""
    return {
        "back_deg": cfg.theta_back_deg,
        "deviation_deg": cfg.theta_dev_deg,
        "forward_m": cfg.forward_m,
        "lateral_m": cfg.lateral_m,
        "min_centroids": cfg.min_centroids,
    }


@dataclass(frozen=True, kw_only=True)
class Surroundings:
    """The verifiers' inputs: the robot's own map and memory, nothing else."""

    pose: Pose
    """From which directions are measured: where the robot will be when it needs the answer."""
    previous: Point | None
    """Previous target waypoint p_prev."""
    robot: Point | None = None
    """Where the robot is; None: at `pose`."""
    ahead: Sequence[Point]
    """Unvisited centroids in front of the robot (forward projection >= d_fwd)."""
    chain: Sequence[Point]
    """All centroids, visited or not."""
    dead_end: bool
    """Nothing that is left satisfies Eqs. 4-8, so that turning round is allowed (the paper's exemption)."""


def angle_between(a: Point, b: Point) -> float:
    """Unsigned angle between two vectors, in [0, pi]; 0 when one of them vanishes."""
    cross, dot = a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]
    return abs(math.atan2(cross, dot)) if cross or dot else 0.0


def behind_robot(p: Point, pose: Pose, cfg: VerifyCfg) -> bool:
    """Eq. 4: the waypoint lies more than theta_back off the robot's heading."""
    forward, left = to_robot(pose, *p)
    return abs(math.atan2(left, forward)) > math.radians(cfg.theta_back_deg)


def behind_previous(p: Point, robot: Point, previous: Point | None, cfg: VerifyCfg) -> bool:
    """Eq. 5: seen from the previous target, the waypoint lies back towards the robot (unless far away)."""
    if previous is None:
        return False
    back = (robot[0] - previous[0], robot[1] - previous[1])
    new = (p[0] - previous[0], p[1] - previous[1])
    if math.hypot(*new) > cfg.exempt_distance_m or math.hypot(*back) < 1e-6 or math.hypot(*new) < 1e-6:
        return False
    return angle_between(new, back) < math.radians(cfg.theta_behind_deg)


def continuations(around: Surroundings, cfg: VerifyCfg) -> list[tuple[Point, Point | None]]:
    """Eq. 7: directions in which the chain may go on, each with the forward centroid that it points to.

    The paper takes one reference, the farthest unvisited centroid ahead within d_lat. Where the reef forks or turns,
    that refuses a right way on because another dot lies nearer to the heading. Here every unvisited centroid ahead is
    a way on, the paper's reference first. If none is ahead, it is the direction from the farthest centroid behind to
    the robot, with no centroid to coincide with; empty when the chain says nothing.
    """
    pose = around.pose
    ahead = [(to_robot(pose, *c), c) for c in around.ahead]
    ahead = [(rel, c) for rel, c in ahead if rel[0] >= cfg.forward_m]
    if ahead:
        straight = [(rel, c) for rel, c in ahead if abs(rel[1]) < cfg.lateral_m]
        aside = [(rel, c) for rel, c in ahead if abs(rel[1]) >= cfg.lateral_m]
        straight.sort(key=lambda item: -item[0][0])
        aside.sort(key=lambda item: abs(math.atan2(item[0][1], item[0][0])))
        return [((c[0] - pose.x, c[1] - pose.y), c) for _, c in (*straight, *aside)]
    behind = [(to_robot(pose, *c), c) for c in around.chain]
    behind = [(rel, c) for rel, c in behind if rel[0] <= -cfg.forward_m and abs(rel[1]) < cfg.lateral_m]
    if behind:
        far = min(behind)[1]
        return [((pose.x - far[0], pose.y - far[1]), None)]
    return []


def reference(around: Surroundings, cfg: VerifyCfg) -> tuple[Point, Point | None] | None:
    """Return the paper's reference direction (Eq. 7), the first of `continuations`; None if there is none."""
    return next(iter(continuations(around, cfg)), None)


def deviated(p: Point, around: Surroundings, cfg: VerifyCfg) -> float | None:
    """Eq. 8: signed angle (rad, left positive) off the nearest way on where it exceeds theta_dev, else None."""
    if len(around.chain) < cfg.min_centroids:
        return None
    way = (p[0] - around.pose.x, p[1] - around.pose.y)
    angles = []
    for trend, centroid in continuations(around, cfg):
        if centroid is not None and math.hypot(p[0] - centroid[0], p[1] - centroid[1]) <= cfg.coincide_m:
            return None
        angles.append(math.atan2(trend[0] * way[1] - trend[1] * way[0], trend[0] * way[0] + trend[1] * way[1]))
    angle = min(angles, key=abs, default=0.0)
    return angle if abs(angle) > math.radians(cfg.theta_dev_deg) else None


def verify_waypoint(p: Point, around: Surroundings, cfg: VerifyCfg) -> Rejection | None:
    """Both verifiers with their exemptions (Eqs. 4-8); the first violation as a reason the model can use."""
    if around.dead_end:
        return None
    return violation(p, around, cfg)


def violation(p: Point, around: Surroundings, cfg: VerifyCfg) -> Rejection | None:
    """Return the first predicate of Eqs. 4-8 that the waypoint violates, ignoring exemptions."""
    forward, left = to_robot(around.pose, *p)
    bearing = math.degrees(math.atan2(left, forward))
    where = f"it lies {math.hypot(forward, left):.1f} m away at a bearing of {bearing:+.0f}° (left is positive)"
    details = {"x": round(p[0], 3), "y": round(p[1], 3), "bearing_deg": round(bearing, 1)}
    if behind_robot(p, around.pose, cfg):
        return Rejection(
            code="behind-robot",
            details=details,
            reason=f"The chosen point is behind the robot: {where}, and more than {cfg.theta_back_deg:.0f}° off the "
            f"heading is not allowed while there is something ahead. Choose a point in front of the robot.",
        )
    if behind_previous(p, around.robot or around.pose[:2], around.previous, cfg):
        return Rejection(
            code="behind-previous",
            details=details,
            reason=f"The chosen point leads back: {where}, on the robot's side of the previous target. Choose a "
            f"point beyond the previous target or to its side.",
        )
    angle = deviated(p, around, cfg)
    if angle is not None:
        side = "left" if angle > 0 else "right"
        return Rejection(
            code="deviation",
            details={**details, "deviation_deg": round(math.degrees(angle), 1)},
            reason=f"The chosen point deviates to the {side} of the chain's trend by {abs(math.degrees(angle)):.0f}° "
            f"(at most {cfg.theta_dev_deg:.0f}° allowed): {where}. Choose a point that follows the chain.",
        )
    return None
