"""Localization: the robot's pose from drifting odometry and from standing obstacles that it sees again."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, NonNegative, Positive
from coral.reef.camera import CameraCfg
from coral.reef.geometry import Frame, Pose, wrap
from coral.reef.landmarks import LandmarkCfg, LandmarkDetector, Sighting


@dataclass(frozen=True, kw_only=True)
class LocalizationCfg:
    """What is known of the odometry, and how landmarks are measured and told apart."""

    drift_xy: NonNegative = 0.0
    """Random walk of the odometry's position along each axis (m/√s), as its data sheet or a trial gives it. With this
    and the next at 0 the odometry is taken as it is: the paper's positions are exact."""
    drift_theta: NonNegative = 0.0
    """The same of its heading (rad/√s)."""
    period_s: Positive = 0.5
    """Time between measurements. The error of a body's centre depends on the side it is seen from and stays nearly the
    same from picture to picture: pictures at 10 Hz would count it ten times a second."""
    range_sigma_m: Positive = 0.1
    """Standard deviation of the distance to a body's centre, for a thin post (m), ..."""
    range_sigma_radius: NonNegative = 0.3
    """... and what is added for each metre of radius: the bodies are not round. Along one mission on s1 it was 0.04 m
    for round bodies and 0.18 m for those 1.6 times as long as wide, or longer."""
    across_sigma_m: Positive = 0.05
    """The same across the line of sight (m)."""
    across_sigma_radius: NonNegative = 0.15
    """Added across the line of sight for each metre of radius."""
    partial_sigma_m: NonNegative = 0.1
    """Added for a body of which one outline is hidden (m)."""
    radius_sigma_m: Positive = 0.1
    """Standard deviation of a measured radius (m), ..."""
    radius_sigma_radius: NonNegative = 0.4
    """... and what is added for each metre of radius."""
    gate: Positive = 9.2
    """Largest squared Mahalanobis distance between a sighting and its landmark: 99 % of two normal variables."""
    unknown_per_m2: Positive = 0.1
    """Density of obstacles that are not landmarks yet (1/m²); generated reefs have 0.12 in all."""
    certainty: Fraction = 0.7
    """Probability from which a sighting is taken for a landmark and not for another or for an unknown obstacle. The
    less the robot knows where it is, the nearer and lonelier a landmark has to be."""
    new_gate: Positive = 16.0
    """A sighting farther than this from every landmark is a new one; in between it is not used."""
    new_m: Positive = 0.8
    """... if it is also so far away (m): generated reefs keep 1 m between obstacles by default."""
    fresh_s: Positive = 60.0
    """Landmarks found within this time are compared with older ones that they may be."""
    agree_m: Positive = 0.45
    """If one fresh landmark is an old one, others are within this distance of old ones too (m): half a passage."""
    candidate_m: Positive = 3.0
    """Landmarks farther away than this are not compared (m)."""
    landmarks: LandmarkCfg = field(default_factory=LandmarkCfg)


@dataclass(frozen=True)
class LandmarkMatch:
    """A sighting compared with a landmark."""

    distance: float
    """Squared Mahalanobis distance of the positions and radii."""
    likelihood: float
    """Probability density of the sighting if it is this landmark (1/m²)."""
    landmark: int
    residual: NDArray[np.float64]
    """Measured minus mapped position in the world (m). Shape=(2,)."""
    jacobian: NDArray[np.float64]
    """Of the residual, with respect to the odometry's error and the landmark. Shape=(2, 5)."""
    covariance: NDArray[np.float64]
    """Of the residual (m²). Shape=(2, 2)."""


class Localizer:
    """Estimates the odometry's error together with the positions of all landmarks: EKF-SLAM.

    The state is the error of the odometry (x, y, theta: odometry minus pose) and the centres of the landmarks in the
    world. The error is a random walk whose position and heading drift independently. A sighting at z in the body frame
    gives the residual r = p + R(theta) z - l of a landmark l. The full covariance holds how uncertain an old landmark
    is relative to the robot, so one that is seen again after a long way corrects the pose by as much as it should.
    Without a landmark in sight the pose is the odometry less the last known error.

    A sighting that may be an old landmark, but not for sure, starts a fresh one. Once two or more fresh landmarks
    become old ones by the same shift, they are merged, which corrects the pose and everything in between.

    The measured velocity is not used: the simulator's is exact, and its integral would be the true pose.
    """

    def __init__(self, camera: CameraCfg, cfg: LocalizationCfg | None = None) -> None:
        self.cfg = cfg = cfg or LocalizationCfg()
        self._detector = LandmarkDetector(camera, cfg.landmarks)
        self._walk = np.array([cfg.drift_xy, cfg.drift_xy, cfg.drift_theta]) ** 2
        self._state = np.zeros(3)
        self._covariance = np.zeros((3, 3))
        self._radii: list[float] = []
        self._seen: list[int] = []
        self._born_s: list[float] = []
        self._last_s: list[float] = []
        self._now_s = 0.0
        self._waited_s = math.inf

    @property
    def active(self) -> bool:
        """Whether the odometry drifts; if not, poses are returned as they are."""
        return bool(self._walk.any())

    @property
    def landmarks(self) -> NDArray[np.float64]:
        """Centres of the landmarks in the world (m). Shape=(N, 2)."""
        return self._state[3:].reshape(-1, 2).copy()

    @property
    def sigma(self) -> tuple[float, float, float]:
        """Standard deviations of the pose: x (m), y (m), theta (rad)."""
        x, y, theta = np.sqrt(np.diag(self._covariance)[:3]).tolist()
        return x, y, theta

    def update(self, frame: Frame, odometry: Pose, dt: float) -> Pose:
        """Correct the odometry.

        Args:
            frame: The present camera picture.
            odometry: The present pose by odometry alone.
            dt: Time since the last call (s).

        Returns:
            The pose in the map's frame, in which the odometry was exact at the start.
        """
        if not self.active:
            return odometry
        self._covariance[range(3), range(3)] += self._walk * dt
        self._waited_s += dt
        self._now_s += dt
        if self._waited_s >= self.cfg.period_s - 1e-9:
            self._waited_s = 0.0
            for sighting in self._detector.detect(frame):
                self._measure(sighting, self._corrected(odometry))
            self._close_loop()
        return self._corrected(odometry)

    def locate(self, odometry: Pose) -> Pose:
        """Correct a pose by odometry with the error that was last known."""
        return self._corrected(odometry) if self.active else odometry

    def _corrected(self, odometry: Pose) -> Pose:
        x, y, theta = self._state[:3].tolist()
        return Pose(odometry.x - x, odometry.y - y, wrap(odometry.theta - theta))

    def _measure(self, sighting: Sighting, pose: Pose) -> None:
        """Match a sighting to a landmark, or start one."""
        cfg = self.cfg
        here, jacobian, noise = self._place(sighting, pose, sighting.radius_m)
        away = np.hypot(*(self.landmarks - here).T)
        near = np.flatnonzero(away < cfg.candidate_m).tolist()
        matches = sorted((self._compare(sighting, pose, k) for k in near), key=lambda match: match.distance)
        if matches and matches[0].distance < cfg.gate:
            all_of_them = sum(match.likelihood for match in matches) + cfg.unknown_per_m2
            if matches[0].likelihood > cfg.certainty * all_of_them:
                self._correct(matches[0], sighting)
                return
        # One that is not known for sure is a new one, until the loop is closed; unless it was seen a moment ago.
        recent = [match for match in matches if self._now_s - self._last_s[match.landmark] < cfg.fresh_s]
        apart = all(m.distance > cfg.new_gate and away[m.landmark] > cfg.new_m for m in recent)
        if sighting.whole and apart:
            self._start(here, jacobian, noise, sighting.radius_m)

    def _place(
        self, sighting: Sighting, pose: Pose, radius_m: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return a sighting's place in the world, its derivative by the odometry's error, and its covariance.

        Shapes (2,), (2, 3) and (2, 2).
        """
        cfg = self.cfg
        bearing, distance = sighting.centre(radius_m)
        partial = 0.0 if sighting.whole else cfg.partial_sigma_m
        along = cfg.range_sigma_m + cfg.range_sigma_radius * radius_m + partial
        across = cfg.across_sigma_m + cfg.across_sigma_radius * radius_m + partial
        c, s = math.cos(pose.theta + bearing), math.sin(pose.theta + bearing)
        turn = np.array([[c, -s], [s, c]])
        dx, dy = distance * c, distance * s
        jacobian = np.array([[-1.0, 0.0, dy], [0.0, -1.0, -dx]])
        return np.array([pose.x + dx, pose.y + dy]), jacobian, turn @ np.diag([along**2, across**2]) @ turn.T

    def _compare(self, sighting: Sighting, pose: Pose, landmark: int) -> LandmarkMatch:
        cfg, known = self.cfg, self._radii[landmark]
        # Half a body does not show how wide it is.
        radius = sighting.radius_m if sighting.whole else known
        here, by_error, noise = self._place(sighting, pose, radius)
        jacobian = np.hstack([by_error, -np.eye(2)])
        index = self._index(landmark)
        covariance = jacobian @ self._covariance[np.ix_(index, index)] @ jacobian.T + noise
        residual = here - self._state[index[3:]]
        unlike = (radius - known) / (cfg.radius_sigma_m + cfg.radius_sigma_radius * known)
        distance = float(residual @ np.linalg.solve(covariance, residual)) + unlike**2
        likelihood = math.exp(-0.5 * distance) / (2.0 * math.pi * math.sqrt(np.linalg.det(covariance)))
        return LandmarkMatch(distance, likelihood, landmark, residual, jacobian, covariance)

    @staticmethod
    def _index(landmark: int) -> list[int]:
        """Return the places of the odometry's error and of a landmark in the state."""
        return [0, 1, 2, 3 + 2 * landmark, 4 + 2 * landmark]

    def _correct(self, match: LandmarkMatch, sighting: Sighting) -> None:
        """Update the state with a matched sighting (Kalman)."""
        k = match.landmark
        cross = self._covariance[:, self._index(k)] @ match.jacobian.T
        gain = cross @ np.linalg.inv(match.covariance)
        self._state -= gain @ match.residual
        self._covariance -= gain @ cross.T
        self._covariance = 0.5 * (self._covariance + self._covariance.T)
        self._last_s[k] = self._now_s
        if sighting.whole:
            self._seen[k] += 1
            self._radii[k] += (sighting.radius_m - self._radii[k]) / self._seen[k]

    def _start(
        self, here: NDArray[np.float64], jacobian: NDArray[np.float64], noise: NDArray[np.float64], radius_m: float
    ) -> None:
        """Add a landmark to the state."""
        size = len(self._state)
        covariance = np.empty((size + 2, size + 2))
        covariance[:size, :size] = self._covariance
        covariance[size:, :size] = jacobian @ self._covariance[:3]
        covariance[:size, size:] = covariance[size:, :size].T
        covariance[size:, size:] = jacobian @ self._covariance[:3, :3] @ jacobian.T + noise
        self._state, self._covariance = np.concatenate([self._state, here]), covariance
        self._radii.append(radius_m)
        self._seen.append(1)
        self._born_s.append(self._now_s)
        self._last_s.append(self._now_s)

    def _close_loop(self) -> None:
        """Find out whether fresh landmarks are old ones: at least two of them, shifted alike."""
        cfg = self.cfg
        fresh = [k for k, born in enumerate(self._born_s) if self._now_s - born < cfg.fresh_s and self._seen[k] > 1]
        if len(fresh) < 2:
            return
        found: list[list[tuple[int, int]]] = []
        for k in fresh:
            for old in range(k):
                if self._may_be(k, old):
                    offset, distance, covariance, cross = self._apart(k, old)
                    if distance < cfg.gate:
                        centres = (self._state - cross @ np.linalg.solve(covariance, offset))[3:].reshape(-1, 2)
                        others = (self._twin(other, old, centres) for other in fresh if other != k)
                        found.append(sorted([(k, old), *(pair for pair in others if pair is not None)]))
        best = max(found, key=len, default=[])
        if len(best) < 2 or any(len(pairs) == len(best) and not set(pairs) & set(best) for pairs in found):
            return
        for k, old in best:
            self._state, self._covariance = self._merged(k, old)
        for k, _ in sorted(best, reverse=True):
            self._drop(k)

    def _twin(self, k: int, taken: int, centres: NDArray[np.float64]) -> tuple[int, int] | None:
        """Pair a fresh landmark with the nearest old one but `taken`, if the centres agree. centres: Shape=(N, 2)."""
        away = np.hypot(*(centres[:k] - centres[k]).T)
        near = [(float(away[j]), j) for j in np.flatnonzero(away < self.cfg.agree_m).tolist() if j != taken]
        near = [pair for pair in near if self._may_be(k, pair[1])]
        return (k, min(near)[1]) if near else None

    def _may_be(self, k: int, old: int) -> bool:
        """Check whether two landmarks may be one: alike in size, the old one out of sight since the other appeared."""
        unlike = abs(self._radii[k] - self._radii[old])
        return (
            self._last_s[old] < self._born_s[k]
            and self._born_s[old] < self._born_s[k]
            and unlike < 2.0 * (self.cfg.radius_sigma_m + self.cfg.radius_sigma_radius * self._radii[old])
        )

    def _apart(self, k: int, old: int) -> tuple[NDArray[np.float64], float, NDArray[np.float64], NDArray[np.float64]]:
        """Return the offset of two landmarks, its squared Mahalanobis distance, covariance, and that with the state."""
        cfg = self.cfg
        a, b = slice(3 + 2 * k, 5 + 2 * k), slice(3 + 2 * old, 5 + 2 * old)
        cross = self._covariance[:, a] - self._covariance[:, b]
        shape = (cfg.range_sigma_m + cfg.range_sigma_radius * self._radii[old]) ** 2
        covariance = cross[a] - cross[b] + shape * np.eye(2)
        offset = self._state[a] - self._state[b]
        return offset, float(offset @ np.linalg.solve(covariance, offset)), covariance, cross

    def _merged(self, k: int, old: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return state and covariance if two landmarks are one."""
        offset, _, covariance, cross = self._apart(k, old)
        gain = cross @ np.linalg.inv(covariance)
        after = self._covariance - gain @ cross.T
        return self._state - gain @ offset, 0.5 * (after + after.T)

    def _drop(self, k: int) -> None:
        """Remove a landmark that has been merged into an older one."""
        keep = np.delete(np.arange(len(self._state)), [3 + 2 * k, 4 + 2 * k])
        self._state, self._covariance = self._state[keep], self._covariance[np.ix_(keep, keep)]
        for values in (self._radii, self._seen, self._born_s, self._last_s):
            del values[k]
