"""Localization: the robot's pose from drifting odometry and from standing obstacles that it sees again."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, NonNegative, Positive
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.map.landmarks import LandmarkCfg, LandmarkDetector, Sighting
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose

UNUSED, NEW = -2, -1
"""Instead of the number of a landmark: the sighting shows none that is known, and starts one (NEW) or not."""
ALIKE_M, ALIKE_RAD = 0.2, 0.035
"""Of two hypotheses the less likely one is dropped if their positions differ by less than this on each axis, and their
headings, too. A fifth of the distance between obstacles: the next landmark that could be meant lies farther off. With
0.02 m, variants of one hypothesis took all the room, and a loop closed with the wrong landmark had no rival left."""
CANDIDATE_M = 3.0
"""Landmarks farther away than this are not compared."""
UNKNOWN_PER_M2 = 0.3
"""Density of obstacles that are no landmarks yet. Generated reefs have 0.12 in all, but one wrong match turns the map
for good, and an obstacle that is taken for a new one costs little (docs/research/robustness.md)."""
RADIUS_SPAN_M = 0.6
"""Radii of unknown obstacles are spread evenly over this: reefs have posts of 0.1 m and rocks of 0.7 m."""
FRESH_S, APART_M, SAME_M = 60.0, 0.8, 0.4
"""A landmark seen within this time is known well: a new one is unlikely this near to it (generated reefs keep 1 m
between obstacles by default), and none is started nearer than the last."""
START_RAD = math.radians(10.0)
"""Standard deviation of the heading at a resumed survey's start: a poor compass, or a vehicle aimed by eye."""
OTHER_REEF = 8.0
"""Saved landmarks are those of this place once that is more likely by this (a logarithm): by chance, two that lie right
gain 2 to 3. From then on they are as long as it is more likely at all."""
SURVEYED_M = 2.0
"""This near to a saved landmark, a body that the earlier survey did not see is as unlikely as one near a fresh one."""
MISTAKEN_M = 0.5
"""A picture was taken somewhere else than believed if the hypothesis that has prevailed puts it this far away (m)."""


@dataclass(frozen=True, kw_only=True)
class LocalizationCfg:
    """What is known of the odometry, and how sightings are matched with landmarks."""

    drift_xy: NonNegative = 0.0
    """Random walk of the odometry's position along each axis (m/√s), as its data sheet or a trial gives it. With this
    and the next at 0 the odometry is taken as it is. Departs from the paper: above 0 the robot finds its place by
    landmarks; its positions are exact, as at 0."""
    drift_theta: NonNegative = 0.0
    """The same of its heading (rad/√s)."""
    use_covariance: bool = True
    """Whether the covariance that the odometry reports, if any, replaces the two random walks."""
    period_s: Positive = 0.5
    """Time between measurements. The error of a body's centre depends on the side it is seen from and stays nearly the
    same from picture to picture: pictures at 10 Hz would count it ten times a second."""
    hypotheses: Count = 24
    """Most hypotheses. A wrong match is found out when a hypothesis that did without it explains more of what comes
    later: some ten sightings later where two obstacles are alike, so there must be room for both until then."""
    entries: Count = 1_000_000
    """Most entries of all covariances together: it bounds the time of a measurement on large reefs. 24 hypotheses of
    100 landmarks have as many; with 500 landmarks one is left."""
    less_likely: Positive = 20.0
    """A hypothesis is dropped whose logarithm of the likelihood is smaller than the best one's by this: five sightings
    that the other explains and it calls unknown."""
    gate: Positive = 16.0
    """Largest squared Mahalanobis distance between a sighting and its landmark: 99.9 % of three normal variables."""
    beside: Positive = 0.2
    """Share by which unknown obstacles are rarer near landmarks that are known well."""
    start_m: Positive = 1.0
    """How far off a resumed survey may begin along each axis (m, one standard deviation): a boat at a buoy."""
    landmarks: LandmarkCfg = field(default_factory=LandmarkCfg)


@dataclass(frozen=True)
class Hypothesis:
    """One history of matches."""

    map: LandmarkMap
    score: float = 0.0
    """Logarithm of its likelihood, 0 for the best one."""
    past: tuple[Any, ...] = ()
    """While others differ: its last measurement's (picture, error along x, along y), and the `past` before that."""
    saved: int = 0
    """How many of the map's landmarks, the first ones, are those of an earlier survey."""


class Localizer:
    """Estimates the odometry's error and the landmarks by multi-hypothesis EKF-SLAM.

    Obstacles look alike, so a sighting may show one of several landmarks, or none. Each hypothesis is one history of
    such choices, with an EKF-SLAM map of its own (`LandmarkMap`). A sighting makes of every hypothesis one for each
    landmark within the gate, and one in which it shows an unknown obstacle. It multiplies the likelihood by the
    density of the sighting, N(r; 0, S) for a landmark or that of unknown obstacles. The most likely ones are kept
    (Reid 1979; Cox and Leonard 1994), and the pose is that of the best. So a choice that later sightings speak against
    is taken back, together with what it did to the map and the pose, which a single EKF cannot do.

    Without a landmark in sight the pose is the odometry less the last known error.

    The measured velocity is not used: the simulator's is exact, and its integral would be the true pose.
    """

    def __init__(self, camera: CameraCfg, cfg: LocalizationCfg | None = None) -> None:
        self.cfg = cfg = cfg or LocalizationCfg()
        self._detector = LandmarkDetector(camera, cfg.landmarks)
        self._walk = np.array([cfg.drift_xy, cfg.drift_xy, cfg.drift_theta]) ** 2
        self.hypotheses = [Hypothesis(LandmarkMap())]
        """The most likely one first."""
        self._last: tuple[Pose, NDArray[np.float64]] | None = None
        """The odometry of the last call, and its covariance."""
        self._keeps, self.saved = False, 0
        """Whether landmarks are kept even if the odometry is exact; how many an earlier survey had."""
        self._now_s = 0.0
        self._waited_s = math.inf
        self._picture = 0
        self._believed: dict[int, tuple[float, float]] = {}
        """The error that was believed at each measurement while hypotheses differed, by the number of its picture."""
        self.mistaken: list[tuple[int, int]] = []
        """What came out in the last `update`: spans of earlier pictures that were placed by a hypothesis that has lost,
        the first and the one after the last, counted back from the one before this update's; mostly none."""

    @property
    def active(self) -> bool:
        """Whether the odometry drifts; if not, poses are returned as they are."""
        return bool(self._walk.any()) or self._last is not None or self._keeps

    @property
    def recognised(self) -> int:
        """How many landmarks of an earlier survey the best hypothesis has seen again."""
        best = self.hypotheses[0]
        return int(np.isfinite(best.map.last_s[: best.saved]).sum())

    @property
    def kept(self) -> LandmarkMap:
        """Landmarks for a later survey, with those of an earlier one unless they have proved to be elsewhere."""
        return next((one.map for one in self.hypotheses if one.saved), self.hypotheses[0].map)

    def recall(self, landmarks: LandmarkMap) -> None:
        """Begin with the landmarks of an earlier survey, in whose frame the start is known roughly; keep new ones, too.

        That they are elsewhere is the first hypothesis: while it is the best, they do not move the pose.
        """
        self._keeps, self.saved = True, len(landmarks.centres)
        if self.saved:
            begun = landmarks.begun_anew((self.cfg.start_m, self.cfg.start_m, START_RAD))
            self.hypotheses = [Hypothesis(LandmarkMap()), Hypothesis(begun, saved=self.saved)]

    @property
    def sigma(self) -> tuple[float, float, float]:
        """Standard deviations of the pose under the best hypothesis: x (m), y (m), theta (rad)."""
        return self.hypotheses[0].map.sigma

    def update(
        self,
        frame: Frame,
        odometry: Pose,
        dt: float,
        covariance: NDArray[np.float64] | None = None,
        sees_m: float = math.inf,
    ) -> Pose:
        """Correct the odometry.

        Args:
            frame: The present camera picture.
            odometry: The present pose by odometry alone.
            dt: Time since the last call (s).
            covariance: Of the odometry since the start: x, y (m), theta (rad); None: unknown. Shape=(3, 3).
            sees_m: Distance up to which what the picture shows is to be trusted (m).

        Returns:
            The pose in the map's frame, in which the odometry was exact at the start.
        """
        told = covariance if covariance is not None and self.cfg.use_covariance else None
        if told is None and not self.active:
            return odometry
        if told is not None or self.saved:
            self._follow(odometry, told, dt)
        else:
            for hypothesis in self.hypotheses:
                hypothesis.map.drift(self._walk * dt)
        self._waited_s += dt
        self._now_s += dt
        self._picture += 1
        self.mistaken = []
        if self._waited_s >= self.cfg.period_s - 1e-9:
            self._waited_s = 0.0
            for sighting in self._detector.detect(frame, sees_m):
                self._measure(sighting, odometry)
            self._remember()
        return self.locate(odometry)

    def _remember(self) -> None:
        """Note where each hypothesis puts the picture; once all that are left agree, find what was misplaced."""
        best = self.hypotheses[0]
        if all(math.dist(one.map.error[:2], best.map.error[:2]) < MISTAKEN_M for one in self.hypotheses):
            times = [*self._believed, self._picture]
            after = dict(pairwise(times))
            last = self._picture - 1
            self.mistaken = [
                (last - picture, last - after[picture])
                for picture, x, y in _steps(best.past)
                if math.dist(self._believed[picture], (x, y)) >= MISTAKEN_M
            ]
            self._believed = {}
            self.hypotheses = [replace(one, past=()) for one in self.hypotheses]
        else:
            self._believed[self._picture] = best.map.error[:2]
            self.hypotheses = [
                replace(one, past=(self._picture, *one.map.error[:2], one.past)) for one in self.hypotheses
            ]

    def locate(self, odometry: Pose) -> Pose:
        """Correct a pose by odometry with the error that was last known."""
        return self.hypotheses[0].map.pose(odometry) if self.active else odometry

    def _follow(self, odometry: Pose, covariance: NDArray[np.float64] | None, dt: float) -> None:
        """Add to the error what the odometry has lost since the last call: by its own word, or by the random walk."""
        before, spread = self._last or (odometry, np.zeros((3, 3)))
        dx, dy = odometry.x - before.x, odometry.y - before.y
        if covariance is None:
            covariance = spread + np.diag(self._walk * dt)
        grow = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        new = covariance - grow @ spread @ grow.T
        values, axes = np.linalg.eigh(0.5 * (new + new.T))
        noise = (axes * np.maximum(values, 0.0)) @ axes.T  # what a correction took away stays in the error
        for hypothesis in self.hypotheses:
            hypothesis.map.propagate((dx, dy), noise)
        self._last = odometry, covariance

    def _measure(self, sighting: Sighting, odometry: Pose) -> None:
        """Replace the hypotheses by the most likely of those that a sighting makes of them."""
        cfg = self.cfg
        choices = [
            (score, k, choice)
            for k, hypothesis in enumerate(self.hypotheses)
            for score, choice in self._choices(hypothesis, sighting, odometry)
        ]
        choices.sort(key=lambda choice: -choice[0])
        room = min(cfg.hypotheses, max(1, cfg.entries // self.hypotheses[choices[0][1]].map.size))
        best = choices[0][0]
        kept: list[Hypothesis] = []
        for score, k, choice in choices[:room]:
            if score < best - cfg.less_likely:
                break
            before = self.hypotheses[k]
            after = replace(before, map=self._chosen(before.map, choice, sighting, odometry), score=score - best)
            if not any(self._alike(after, other) for other in kept):
                kept.append(after)
        doubt = 0.0 if self.hypotheses[0].saved else OTHER_REEF
        self.hypotheses = sorted(kept, key=lambda one: (doubt if one.saved else 0.0) - one.score)

    def _choices(self, hypothesis: Hypothesis, sighting: Sighting, odometry: Pose) -> list[tuple[float, int]]:
        """Return what a sighting may show, as the score that results and a landmark's number, NEW or UNUSED."""
        cfg, landmarks = self.cfg, hypothesis.map
        away_m, squared, log_density = landmarks.compare(sighting, odometry, CANDIDATE_M)
        # A landmark appears once in a picture.
        free = np.flatnonzero((squared < cfg.gate) & (landmarks.last_s < self._now_s))
        # The density of a whole body is per metre of radius too: relative to that of unknown obstacles.
        by_radius = math.log(RADIUS_SPAN_M) if sighting.whole else 0.0
        choices = [(hypothesis.score + float(log_density[j]) + by_radius, int(j)) for j in free]
        recent = away_m[self._now_s - landmarks.last_s < FRESH_S]
        nearest = float(recent.min(initial=math.inf))
        new = sighting.whole and nearest >= SAME_M
        surveyed = new and float(away_m[: hypothesis.saved].min(initial=math.inf)) < SURVEYED_M
        unknown = UNKNOWN_PER_M2 * (cfg.beside if nearest < APART_M or surveyed else 1.0)
        return [*choices, (hypothesis.score + math.log(unknown), NEW if new else UNUSED)]

    def _chosen(self, before: LandmarkMap, choice: int, sighting: Sighting, odometry: Pose) -> LandmarkMap:
        if choice == UNUSED:
            return before
        if choice == NEW:
            return before.extended(sighting, odometry, self._now_s)
        return before.corrected(choice, sighting, odometry, self._now_s)

    def _alike(self, one: Hypothesis, other: Hypothesis) -> bool:
        """Check whether two hypotheses give the same pose, on the same map."""
        x, y, theta = (abs(a - b) for a, b in zip(one.map.error, other.map.error, strict=True))
        return max(x, y) < ALIKE_M and theta < ALIKE_RAD and one.saved == other.saved


def _steps(past: tuple[Any, ...]) -> Iterator[tuple[int, float, float]]:
    """Walk back through a hypothesis's past: (picture, error along x, along y)."""
    while past:
        yield past[0], past[1], past[2]
        past = past[3]
