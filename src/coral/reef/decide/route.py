"""The route: the goals that have been decided on, in order, and when each of them is done (beyond the paper)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.reef.decide.said import SAME_M
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Track
from coral.reef.map.costfield import CostField
from coral.reef.world.geometry import Pose, bearing

FACED_RAD = 0.2
"""What is looked at is faced so exactly."""
BESIDE_M, AHEAD_RAD, ASTRAY_RAD = 0.3, 1.2, 0.5
"""Something is beside the robot, ahead of it, and the way leads elsewhere: turn on the spot."""


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A waypoint in the world (m), and the centroid label it stands for (None: a free waypoint)."""

    x: float
    y: float
    index: int | None = None
    pass_m: float | None = None
    """A waypoint of a look, which nothing new breaks off: how near it must be passed (m). None: as `RouteCfg` says."""
    face: tuple[float, float] | None = None
    """What the robot turns to there (m) before the goal is done."""


AIM_M = 0.75
"""The vehicle aims at the middle of what is left to see within this of the part that it comes to first."""
HOLD_AIM_M = 0.4
"""The aim stays where it is until it would move by more than this."""
LOOK_M = 3.0
"""A waypoint shows the water within this of it..."""
EXPLORED_SHARE = 0.03
"""... and is done once no more than this share of it is unexplored, if there was more before."""
FRUITLESS_SHARE = 0.01
"""A waypoint in unexplored water that has shown no more than this share of it when it is reached was to no purpose:
shadows of obstacles that nobody can look behind are not gone to for ever."""
REACHED_M = 3.0
"""How near to its aim the vehicle is beside it."""


@dataclass(frozen=True, kw_only=True)
class RouteCfg:
    """How goals are driven to, one after the other."""

    ahead: bool = True
    """Ask for the next goal while there is still way to go, and measure it from where the robot will be then. Departs
    from the paper: it asks near the goal, measures from the robot, and turns to the new goal at once (False)."""
    cruise_m_s: Positive = 0.5
    """Expected speed along a path: max_speed of 0.6 m/s less turns and detours."""
    reach_m: Positive = 1.0
    """A waypoint is done this near to it."""
    pass_m: Positive = 2.0
    """The same while another goal follows: there is no need to go all the way."""
    short_m: Positive = 1.2
    """The vehicle is done with a cluster about this far before its end: it looks ahead."""
    patience_s: Positive = 6.0
    """What is left of a cluster is given up when this long beside it showed nothing more of it."""
    expected_latency_s: Positive = 10.0
    """How long an advisor is expected to think before the first answer has shown it; the paper's median (IV-E)."""
    margin_s: Positive = 2.0
    """By how much the next goal should be known before the present one is done."""


@dataclass(frozen=True)
class Arrival:
    """Where the robot will be when the answer to a question asked now is needed."""

    pose: Pose
    in_s: float
    """Seconds until then."""
    path: NDArray[np.float64]
    """Poses on the way there, about 0.5 m apart, the last one `pose`. Shape=(N, 3)."""
    goals: tuple[Goal, ...] = ()
    """The goals that will be done by then, whatever is answered."""
    kept: int = 1
    """How many poses of the path lead up to the last of them: the answer may change the way from there on."""


def here(belief: Belief) -> Arrival:
    """Return the arrival of a robot that is where it is going."""
    return Arrival(pose=belief.pose, in_s=0.0, path=np.array([belief.pose]))


class Route:
    """Keeps the goals in order; the belief's goal is what the vehicle aims at for the first of them."""

    def __init__(self, belief: Belief, cfg: RouteCfg | None = None, clear_m: float = 0.0) -> None:
        """Start without goals; keep `clear_m` from clusters that are no goal."""
        self.belief, self.cfg = belief, cfg or RouteCfg()
        self.belief.clear_m = clear_m
        self.goals: tuple[Goal, ...] = ()
        self.ruled_out: tuple[tuple[float, float], ...] = ()
        """Places (m) of things that are not gone to, whether or not the map still shows a cluster there."""
        self.latency_s = self.cfg.expected_latency_s
        """How long the next answer is expected to take (s): the median of the latest ones."""
        self.t = 0.0
        """Time of the last update (s)."""
        self._latencies: list[float] = []
        self._left, self._since = -1, -math.inf
        self._unexplored = self._showed = 0.0
        self._arrived = False

    def answered(self, seconds: float) -> None:
        """Learn how long an answer took (s)."""
        self._latencies = [*self._latencies[-4:], seconds]
        self.latency_s = float(np.median(self._latencies))

    @property
    def looking(self) -> bool:
        """Whether the robot is on its way round something to look at it."""
        return any(goal.pass_m is not None for goal in self.goals)

    def turn_rad(self, field: CostField) -> float:
        """Return the angle to turn on the spot, positive to the left; 0: none.

        What is looked at is faced. Beside something that is not gone to, the robot first turns to its way along the
        field: under way, it would drive a bow over it.
        """
        belief = self.belief
        if not self.goals:
            return 0.0
        if self._arrived and (face := self.goals[0].face) is not None:
            return bearing(belief.pose, *face)
        near_m = belief.clear_m + BESIDE_M
        ahead = (
            math.dist(at, belief.pose[:2]) < near_m and abs(bearing(belief.pose, *at)) < AHEAD_RAD
            for at in belief.unchosen
        )
        if not belief.clear_m or not any(ahead):
            return 0.0
        way = field.path_from(*belief.pose[:2], step_m=0.2)[:6]
        turn = bearing(belief.pose, float(way[-1, 0]), float(way[-1, 1])) if len(way) > 1 else 0.0
        return turn if abs(turn) > ASTRAY_RAD else 0.0

    @property
    def lead_s(self) -> float:
        """How long before the end of a goal its successor should be asked for (s)."""
        return self.latency_s + self.cfg.margin_s

    def follow(self, goals: Sequence[Goal], t: float) -> None:
        """Set the goals from time `t` (s) on; the first one is under way at once."""
        same = bool(self.goals) and bool(goals) and self.goals[0] == goals[0]
        self.goals = tuple(goals)
        if not same:
            self._begin(t)

    def update(self, t: float) -> bool:
        """Move the aim along, and go on to the next goal when the present one is done; True when that happened."""
        self.t, before = t, self.goals
        self._keep_clear()
        moved = before[:1] != self.goals[:1]
        if moved:
            self._begin(t)
        while self.goals and self._done(t):
            self.goals = self.goals[1:]
            self._begin(t)
            moved = True
        return moved

    def drop(self, t: float) -> None:
        """Give up the present goal."""
        self.goals = self.goals[1:]
        self._begin(t)

    def to_go_s(self, field: CostField | None) -> float:
        """Estimate the time (s) until all goals are done."""
        return sum(leg[1] for leg in self._legs(field))

    def arrival(self, field: CostField | None) -> Arrival:
        """Predict where the robot will be when an answer comes, and which goals it will have done by then."""
        belief, legs, cfg = self.belief, self._legs(field), self.cfg
        if not legs:
            return here(belief)
        points, seconds, goals, kept = [np.array([belief.pose[:2]])], 0.0, [], 1
        for goal, (path, duration) in zip(self.goals, legs, strict=True):
            late_s = seconds + duration - self.lead_s
            if late_s > 0.0:  # the answer comes on the way to this goal, and may change it
                points.append(_shortened(path, late_s * cfg.cruise_m_s))
                seconds += duration - late_s
                break
            points.append(path)
            seconds += duration
            goals.append(goal)
            kept = len(_spaced(np.concatenate(points), 0.5))
        path = _spaced(np.concatenate(points), 0.5)
        headings = np.arctan2(np.diff(path[:, 1]), np.diff(path[:, 0])) if len(path) > 1 else np.empty(0)
        theta = np.concatenate([[belief.pose.theta], headings])
        poses = np.column_stack([path, theta])
        return Arrival(pose=Pose(*poses[-1].tolist()), in_s=seconds, path=poses, goals=tuple(goals), kept=kept)

    def _legs(self, field: CostField | None) -> list[tuple[NDArray[np.float64], float]]:
        """Path, Shape=(N, 2), and duration (s) of every goal, from the end of the one before."""
        legs, at, cfg = [], np.array(self.belief.pose[:2]), self.cfg
        for k, goal in enumerate(self.goals):
            if k == 0 and field is not None:
                path = field.path_from(float(at[0]), float(at[1]), step_m=0.2)
            else:
                path = np.linspace(at, (goal.x, goal.y), 2 + int(math.dist(at, (goal.x, goal.y)) / 0.2))
            path = _shortened(path, cfg.short_m if goal.index is not None else cfg.reach_m)
            length = float(np.hypot(*np.diff(path, axis=0).T).sum()) if len(path) > 1 else 0.0
            legs.append((path, length / cfg.cruise_m_s))
            at = path[-1]
        return legs

    def _begin(self, t: float) -> None:
        self._left, self._since, self._arrived = -1, t, False
        self._unexplored = self._showed = 0.0
        if not self.goals:
            return
        goal = self.goals[0]
        self.belief.goal, self.belief.goal_index = (goal.x, goal.y), goal.index
        track = self.belief.track(goal.index)
        if self.cfg.ahead and track is not None and len(track.left):
            self.belief.goal = aim(track.left, self.belief.pose, AIM_M)

    def _keep_clear(self) -> None:
        """Tell the belief what is not gone to, and keep a waypoint of no look clear of it."""
        belief = self.belief
        if not belief.clear_m:
            return
        chosen = {goal.index for goal in self.goals}
        dots = tuple((track.x, track.y) for track in belief.tracks if track.index not in chosen)
        known = [(track.x, track.y) for track in belief.tracks]
        gone = (at for at in self.ruled_out if all(math.dist(dot, at) > SAME_M for dot in known))
        belief.unchosen = (*dots, *gone)
        if self.goals and self.goals[0].index is None and self.goals[0].pass_m is None:
            goal = self.goals[0]
            clear = moved_clear((goal.x, goal.y), belief.unchosen, belief.clear_m, belief.pose[:2])
            if belief.goal is None or math.dist(clear, belief.goal) > HOLD_AIM_M:
                belief.goal = clear

    def _done(self, t: float) -> bool:
        goal, cfg, belief = self.goals[0], self.cfg, self.belief
        if goal.index is None or not belief.cfg.inspect.enabled:
            near = goal.pass_m or (cfg.reach_m if len(self.goals) == 1 else cfg.pass_m)
            at = belief.goal if goal.pass_m is None and belief.clear_m and belief.goal else (goal.x, goal.y)
            if goal.face is not None:
                self._arrived = self._arrived or math.dist(at, belief.pose[:2]) < near
                return self._arrived and abs(bearing(belief.pose, *goal.face)) < FACED_RAD
            explored = self._explored(goal)
            if math.dist(at, belief.pose[:2]) >= near:
                return explored
            if (
                cfg.ahead
                and goal.pass_m is None
                and self._unexplored > EXPLORED_SHARE
                and self._showed <= FRUITLESS_SHARE
            ):
                belief.goal_fruitless()
            return True
        track = belief.track(goal.index)
        if track is None or track.visited or not len(track.left):
            return True
        if abs(len(track.left) - self._left) > 3:  # cells of oysters
            self._left, self._since = len(track.left), t
        assert belief.goal is not None
        aimed = aim(track.left, belief.pose, AIM_M)
        if math.dist(aimed, belief.goal) > HOLD_AIM_M:
            belief.goal = aimed
        if math.dist(belief.goal, belief.pose[:2]) > REACHED_M:
            self._since = t
        if t - self._since > cfg.patience_s:
            belief.write_off(track.index)
            belief.goal_failed("what is left of it could not be seen from near")
            return True
        return False

    def _explored(self, goal: Goal) -> bool:
        """Check whether a waypoint that was to explore water has nothing more to show: all of it has been seen."""
        share = self.belief.map.unexplored_share(goal.x, goal.y, LOOK_M)
        self._unexplored = max(self._unexplored, share)
        self._showed = self._unexplored - share
        return self.cfg.ahead and self._unexplored > EXPLORED_SHARE >= share


def aim(left: NDArray[np.float64], pose: Pose, within_m: float) -> tuple[float, float]:
    """Return where to drive to see what is left of a cluster, Shape=(L, 2), metres: to the part of it reached first."""
    offset = left - np.array(pose[:2])
    off = np.arctan2(offset[:, 1], offset[:, 0]) - pose.theta
    turn = np.abs(np.arctan2(np.sin(off), np.cos(off)))
    first = left[np.argmin(np.hypot(offset[:, 0], offset[:, 1]) + turn)]
    part = left[np.hypot(left[:, 0] - first[0], left[:, 1] - first[1]) <= within_m]
    return float(part[:, 0].mean()), float(part[:, 1].mean())


def moved_clear(
    goal: tuple[float, float], places: Sequence[tuple[float, float]], clear_m: float, robot: tuple[float, float]
) -> tuple[float, float]:
    """Return the point nearest to a goal that is `clear_m` from the place beside it."""
    x, y = min(places, key=lambda place: math.dist(place, goal), default=(math.inf, math.inf))
    if math.dist((x, y), goal) >= clear_m:
        return goal
    toward = goal if math.dist((x, y), goal) > 0.3 else robot
    angle = math.atan2(toward[1] - y, toward[0] - x)
    return x + clear_m * math.cos(angle), y + clear_m * math.sin(angle)


def passed(track: Track, path: NDArray[np.float64], near_m: float, view_rad: float = 1.0) -> NDArray[np.float64]:
    """Return what will be left to see of a cluster after a drive along poses, Shape=(N, 3). Shape=(L', 2), metres.

    A point is taken to be seen from a pose when it lies within `near_m` and `view_rad` of the heading.
    """
    left = track.left
    for x, y, theta in path:
        if not len(left):
            break
        forward, aside = np.cos(theta), np.sin(theta)
        dx, dy = left[:, 0] - x, left[:, 1] - y
        ahead, across = forward * dx + aside * dy, -aside * dx + forward * dy
        seen = (np.hypot(ahead, across) <= near_m) & (np.abs(np.arctan2(across, ahead)) <= view_rad)
        left = left[~seen]
    return left


def _shortened(path: NDArray[np.float64], by_m: float) -> NDArray[np.float64]:
    """Cut the end off a path; its first point stays."""
    if len(path) < 2:
        return path
    steps = np.hypot(*np.diff(path, axis=0).T)
    to_end = steps[::-1].cumsum()[::-1]
    return path[: max(1, int(np.count_nonzero(to_end > by_m)) + 1)]


def _spaced(path: NDArray[np.float64], step_m: float) -> NDArray[np.float64]:
    """Thin a path to points about `step_m` apart, ends kept. Shape=(N, 2)."""
    kept = [path[0]]
    for point in path[1:-1]:
        if math.dist(point, kept[-1]) >= step_m:
            kept.append(point)
    if len(path) > 1 and math.dist(path[-1], kept[-1]) > 1e-6:
        kept.append(path[-1])
    return np.array(kept)
