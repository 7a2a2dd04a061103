"""Everything the robot knows, and nothing else: the only input of its decisions."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.config import Count
from coral.reef.map.best_views import BestViews
from coral.reef.map.carried import is_jump, moved
from coral.reef.map.chain import CentroidTracker, ChainCfg, InspectCfg, Track, components
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.glimpses import Glimpses
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.water import Water
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Frame, Pose


@dataclass(frozen=True, kw_only=True)
class BeliefCfg:
    """How the robot keeps its memory."""

    chain: ChainCfg = field(default_factory=ChainCfg)
    centroids: bool = True
    """Whether clusters are extracted at all. False is DREAM: no chain in its picture, its prompt and its facts."""
    inspect: InspectCfg = field(default_factory=InspectCfg)
    chain_period: Count = 5
    """Ticks between updates of the centroid chain."""
    visit_radius_m: float = 3.0
    """Without `inspect`, a centroid counts as visited once the robot has been this close: D_trig, where its next goal
    is asked for, and 0.5 m for what its centroid may still move."""
    max_attempts: int = 2
    """Goals towards one centroid that may fail before it is given up."""
    trail_step_m: float = 0.1
    """Spacing of the remembered trajectory."""


class Belief:
    """The robot's map, centroid chain, own pose, trajectory and goals."""

    def __init__(self, occupancy: OccupancyMap, cfg: BeliefCfg | None = None) -> None:
        self.cfg = cfg or BeliefCfg()
        self.map = occupancy
        self.tracker = CentroidTracker(self.cfg.chain)
        self.pose = Pose(0.0, 0.0, 0.0)
        self.frame: Frame | None = None
        self.goal: tuple[float, float] | None = None
        self.goal_index: int | None = None
        """Label of the cluster that the goal stands for."""
        self.clear_m = 0.0
        self.unchosen: tuple[tuple[float, float], ...] = ()
        """Places from which the way keeps `clear_m` (m), where it can."""
        self.last_failure: tuple[int | None, str] | None = None
        """Label (None: a waypoint) and cause of the last goal that failed, until a decision after it has been made."""
        self.best_views = BestViews(occupancy.camera)
        self.glimpses = Glimpses()
        self._trail: list[tuple[float, float]] = []
        self._failed: list[tuple[float, float]] = []
        self._fruitless: list[tuple[float, float]] = []
        self._ticks = 0
        self._drawn: tuple[Pose, Pose] | None = None
        """Where the robot would be had nothing been corrected since the map last moved along, and where it is."""
        self._waters: dict[CostFieldCfg, tuple[NDArray[np.float32], Water]] = {}
        """With the distances to obstacles of which each was made."""

    def snapshot(self) -> Belief:
        """Copy all that decisions read, for another thread to work on while this belief changes: some milliseconds."""
        copied = copy.copy(self)
        copied.map, copied.tracker = self.map.snapshot(), copy.copy(self.tracker)
        copied.best_views, copied.glimpses = copy.copy(self.best_views), copy.copy(self.glimpses)
        copied._trail, copied._failed, copied._fruitless = (
            self._trail.copy(),
            self._failed.copy(),
            self._fruitless.copy(),
        )
        copied._waters = self._waters.copy()
        return copied

    def forget_doubt(self) -> bool:
        """Forget the obstacles that one place alone has shown, and the goals that have failed; False without any."""
        if not self.map.forget_doubt():
            return False
        self._failed.clear()
        self._fruitless.clear()
        return True

    def correct(self, before: Pose, after: Pose, *, found: bool = False) -> None:
        """Take in a correction of the pose: once it has moved far in all, what is around the robot moves along.

        If it has `found` itself on the map of an earlier survey, all else that it has seen was put elsewhere, and goes.
        """
        drawn = before if self._drawn is None else moved(self._drawn[0], self._drawn[1], before)
        if found or is_jump(drawn, after):
            self.map.carry(drawn, after, anew=found)
            drawn = after
        self._drawn = drawn, after

    def look_again(self, first: int, end: int) -> None:
        """Take back what the robot saw from near in some pictures, see the map; clusters may no longer be visited."""
        self.map.look_again(first, end)

    def water(self, cfg: CostFieldCfg) -> Water:
        """Return the water of the present map."""
        distance = self.map.distance()
        if cfg not in self._waters or self._waters[cfg][0] is not distance:
            self._waters[cfg] = distance, Water.over(distance, self.map.cfg.cell_m, cfg)
        return self._waters[cfg][1]

    def update(self, frame: Frame | None, pose: Pose, attitude: Attitude | None = None) -> None:
        """Take in the robot's pose and the picture taken there, if there is a new one; without an attitude, level."""
        self.pose = pose
        if frame is not None:
            self.frame = frame
            roll, pitch = (0.0, 0.0) if attitude is None else (attitude.roll, attitude.pitch)
            self.map.integrate(frame, pose, roll, pitch)
        if not self._trail or math.dist(self._trail[-1], (pose.x, pose.y)) >= self.cfg.trail_step_m:
            self._trail.append((pose.x, pose.y))
        if self._ticks % self.cfg.chain_period == 0:
            if self.cfg.centroids:
                found = components(self.map.target, self.map.cfg.cell_m, self.cfg.chain)
                self.tracker.update(found, self.map.hints() if self.cfg.inspect.enabled else ())
            if self.cfg.inspect.enabled:
                self._inspect()
            else:
                self.tracker.mark_visited(pose.x, pose.y, self.cfg.visit_radius_m)
            if frame is not None:
                self.best_views.update(frame, pose, self.tracks, self._ticks)
                self.glimpses.update(frame, pose)
        self._ticks += 1

    def distance_in_known_water(self, radius_m: float, hull_m: float) -> NDArray[np.float32]:
        """Return the distances (m) to all that is not known to be free, about the robot; see the map."""
        here = np.array([[self.pose.x, self.pose.y]])
        trail = np.concatenate([self.trajectory, here])
        return self.map.distance_to_unknown(self.pose.x, self.pose.y, radius_m, trail, hull_m)

    def _inspect(self) -> None:
        cells = self.map
        self.tracker.inspect(cells.nearest, cells.unseeable, self.inspect_m, cells.cfg.cell_m, self.cfg.inspect)
        self.tracker.doubt(cells.agreement, self.cfg.inspect.sure)
        for track in self.tracks if cells.estimated else ():
            if len(track.cells) and (cells.hides(track.cells) or self._unconfirmed(track)):
                cells.disbelieve(track.cells)

    def _unconfirmed(self, track: Track) -> bool:
        """Check whether next to nothing was seen from near of a cluster for which nothing more will be done."""
        over = track.visited or self.failures(track.x, track.y) >= self.cfg.max_attempts
        return over and track.inspected < self.cfg.inspect.confirmed

    @property
    def inspect_m(self) -> float:
        """Distance from which oysters can be counted (m)."""
        return self.cfg.inspect.pixel_m * self.map.focal_px

    def recall(self, tracks: Sequence[Track], trail: NDArray[np.float64]) -> None:
        """Take over the clusters and the trajectory, Shape=(N, 2), of an earlier survey. The map recalls itself."""
        self.tracker.recall(tracks)
        self._trail = [(float(x), float(y)) for x, y in trail]

    def write_off(self, index: int) -> None:
        """Give up what is left to see of a cluster: it could not be seen from near.

        Where eyes doubt, one of which next to nothing was seen from near is none.
        """
        for track in self.tracks:
            if track.index == index and not track.far:
                at = np.floor(track.left / self.map.cfg.cell_m).astype(np.intp)
                self.map.unseeable[at[:, 1], at[:, 0]] = True
        self._inspect()

    def track(self, index: int | None) -> Track | None:
        """Return the cluster with this label, if there still is one."""
        return next((t for t in self.tracks if t.index == index), None)

    @property
    def trajectory(self) -> NDArray[np.float64]:
        """The robot's past positions. Shape=(N, 2), metres, oldest first."""
        return np.array(self._trail, dtype=float).reshape(-1, 2)

    @property
    def tracks(self) -> list[Track]:
        """All known clusters."""
        return self.tracker.tracks

    def reef(self) -> NDArray[np.float64]:
        """Places of the known reef: the clusters or, where none are extracted, the oyster cells. Shape=(N, 2), m."""
        if self.cfg.centroids:
            return np.array([(t.x, t.y) for t in self.tracks]).reshape(-1, 2)
        rows, columns = np.nonzero(self.map.target)
        return np.asarray((np.stack([columns, rows], axis=1) + 0.5) * self.map.cfg.cell_m, np.float64)

    def unvisited(self, *, doubtful: bool = False) -> list[Track]:
        """Return the clusters still to be visited, without those whose goals failed too often."""
        return [
            t
            for t in self.tracks
            if not t.visited and self.failures(t.x, t.y) < self.cfg.max_attempts and (doubtful or not t.doubtful)
        ]

    def goal_failed(self, cause: str = "") -> None:
        """Record that the present goal could not be reached, and why."""
        if self.goal is not None:
            self._failed.append(self.goal)
            self.last_failure = (self.goal_index, cause)

    def goal_fruitless(self) -> None:
        """Record that the present waypoint was reached, and showed no water that was unexplored."""
        if self.goal is not None:
            self._fruitless.append(self.goal)

    def failures(self, x: float, y: float) -> int:
        """Count the failed goals near a point."""
        return self._near(self._failed, x, y)

    def worth_exploring(self, x: float, y: float) -> bool:
        """Check whether waypoints near a point have failed or shown nothing less often than `max_attempts`."""
        return self._near([*self._failed, *self._fruitless], x, y) < self.cfg.max_attempts

    def _near(self, places: Sequence[tuple[float, float]], x: float, y: float) -> int:
        return sum(math.dist(place, (x, y)) < self.cfg.chain.merge_distance_m for place in places)
