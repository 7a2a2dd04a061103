"""The paper's formal checks of a chosen waypoint: backward (Eqs. 4-6) and deviation (Eqs. 7-8) (paper III-D)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from coral.advisor.question import Rejection
from coral.reef.world.geometry import Pose, bearing, to_robot

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class VerifyCfg:
    """Thresholds. The paper names them but gives no values; the reasons stand beside each."""

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


@dataclass(frozen=True, kw_only=True)
class Surroundings:
    """The verifiers' inputs: the robot's own map and memory, nothing else."""

    pose: Pose
    """p_r and theta_r."""
    previous: Point | None
    """Previous target waypoint p_prev."""
    ahead: Sequence[Point]
    """Unvisited centroids in front of the robot (forward projection >= d_fwd)."""
    chain: Sequence[Point]
    """All centroids, visited or not."""
    dead_end: bool
    """Nothing lies ahead, neither a centroid nor unexplored water beside the reef."""


def angle_between(a: Point, b: Point) -> float:
    """Unsigned angle between two vectors, in [0, pi]; 0 when one of them vanishes."""
    cross, dot = a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]
    return abs(math.atan2(cross, dot)) if cross or dot else 0.0


def behind_robot(p: Point, pose: Pose, cfg: VerifyCfg) -> bool:
    """Eq. 4: the waypoint lies more than theta_back off the robot's heading."""
    return abs(bearing(pose, *p)) > math.radians(cfg.theta_back_deg)


def behind_previous(p: Point, robot: Point, previous: Point | None, cfg: VerifyCfg) -> bool:
    """Eq. 5: seen from the previous target, the waypoint lies back towards the robot (unless far away)."""
    if previous is None:
        return False
    back = (robot[0] - previous[0], robot[1] - previous[1])
    new = (p[0] - previous[0], p[1] - previous[1])
    if math.hypot(*new) > cfg.exempt_distance_m or math.hypot(*back) < 1e-6 or math.hypot(*new) < 1e-6:
        return False
    return angle_between(new, back) < math.radians(cfg.theta_behind_deg)


def reject_backward(p: Point, around: Surroundings, cfg: VerifyCfg) -> Rejection | None:
    """Eq. 6: either of both, unless no centroid lies ahead (turning round at a dead end)."""
    if not around.ahead:
        return None
    if behind_robot(p, around.pose, cfg):
        return Rejection(code="behind-robot", reason="The chosen point is behind the robot.")
    if behind_previous(p, around.pose[:2], around.previous, cfg):
        return Rejection(code="behind-previous", reason="The chosen point leads back from the previous target.")
    return None


def reference(around: Surroundings, cfg: VerifyCfg) -> tuple[Point, Point | None] | None:
    """Eq. 7: the direction in which the chain continues, and the forward centroid that it points to.

    That is the farthest unvisited centroid ahead within d_lat or, without one, the direction from the farthest
    centroid behind to the robot, with no centroid to coincide with. None when the chain says nothing.
    """
    pose = around.pose
    ahead = [(to_robot(pose, *c), c) for c in around.ahead]
    ahead = [(rel, c) for rel, c in ahead if rel[0] >= cfg.forward_m and abs(rel[1]) < cfg.lateral_m]
    if ahead:
        far = max(ahead)[1]
        return (far[0] - pose.x, far[1] - pose.y), far
    behind = [(to_robot(pose, *c), c) for c in around.chain]
    behind = [(rel, c) for rel, c in behind if rel[0] <= -cfg.forward_m and abs(rel[1]) < cfg.lateral_m]
    if behind:
        far = min(behind)[1]
        return (pose.x - far[0], pose.y - far[1]), None
    return None


def deviated(p: Point, around: Surroundings, cfg: VerifyCfg) -> float | None:
    """Eq. 8: signed angle (rad, left positive) off the reference direction where it exceeds theta_dev, else None."""
    trend = reference(around, cfg)
    if trend is None or len(around.chain) < cfg.min_centroids:
        return None
    (x, y), centroid = trend
    if centroid is not None and math.dist(p, centroid) <= cfg.coincide_m:
        return None
    way = (p[0] - around.pose.x, p[1] - around.pose.y)
    angle = math.atan2(x * way[1] - y * way[0], x * way[0] + y * way[1])
    return angle if abs(angle) > math.radians(cfg.theta_dev_deg) else None


def is_deviated(p: Point, around: Surroundings, cfg: VerifyCfg) -> Rejection | None:
    """Eq. 8 as a failure mode, with the side. At a dead end nothing is off the trend: it has ended."""
    angle = None if around.dead_end else deviated(p, around, cfg)
    if angle is None:
        return None
    side = "left" if angle > 0 else "right"
    return Rejection(code="deviation", reason=f"The chosen point deviates to the {side} of the chain's trend.")


def verify_waypoint(p: Point, around: Surroundings, cfg: VerifyCfg) -> Rejection | None:
    """Return the failure mode of a waypoint, for the next question (paper III-D.3); None if it passes."""
    return reject_backward(p, around, cfg) or is_deviated(p, around, cfg)
