"""EKF-SLAM for one history of matches: the odometry's error and the landmarks, estimated together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.landmark_map_kernels import Outline, compare, correct, start
from coral.reef.map.landmarks import Sighting
from coral.reef.world.geometry import Pose, wrap

RANGE_SIGMA_RADIUS = 0.3
"""What is added to the standard deviation of the distance to a body's centre for each metre of radius: the bodies are
not round."""
ACROSS_SIGMA_M, ACROSS_SIGMA_RADIUS = 0.05, 0.15
"""Standard deviation across the line of sight, for a thin post (m), and what is added for each metre of radius."""
PARTIAL_SIGMA_M = 0.2
"""Added for a body of which one outline is hidden."""
RADIUS_SIGMA_M, RADIUS_SIGMA_RADIUS = 0.1, 0.4
"""Standard deviation of a measured radius (m), and what is added for each metre of radius."""
SIGMAS = (
    RANGE_SIGMA_RADIUS, ACROSS_SIGMA_M, ACROSS_SIGMA_RADIUS, PARTIAL_SIGMA_M, RADIUS_SIGMA_M, RADIUS_SIGMA_RADIUS,
)  # fmt: skip
"""As the kernels take them."""


class LandmarkMap:
    """The Gaussian of the odometry's error and of all landmarks, given which sighting showed which landmark.

    The error (odometry minus pose) is a random walk whose position and heading drift independently. The full covariance
    holds how uncertain an old landmark is relative to the robot, so one that is seen again after a long way corrects
    the pose by as much as it should.
    """

    def __init__(self) -> None:
        """Set up; the odometry is exact at the start."""
        self._state, self._covariance = np.zeros(3), np.zeros((3, 3))
        self._radii, self._hits, self.last_s = np.zeros(0), np.zeros(0), np.zeros(0)
        """Radius of each landmark (m), how often it was seen whole, and when it was seen last (s). Shape=(N,)."""

    @property
    def centres(self) -> NDArray[np.float64]:
        """Centres of the landmarks in the world (m). Shape=(N, 2)."""
        return self._state[3:].reshape(-1, 2).copy()

    @property
    def error(self) -> tuple[float, float, float]:
        """Error of the odometry: x, y (m), theta (rad)."""
        x, y, theta = self._state[:3].tolist()
        return x, y, theta

    @property
    def sigma(self) -> tuple[float, float, float]:
        """Standard deviations of the error: x (m), y (m), theta (rad)."""
        x, y, theta = np.sqrt(np.diag(self._covariance)[:3]).tolist()
        return x, y, theta

    @property
    def size(self) -> int:
        """Number of entries of the covariance."""
        return int(self._covariance.size)

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return the arrays from which `recalled` makes the landmarks again, by name."""
        about = np.column_stack([self.centres, self._radii, self._hits])
        return {"landmarks": about, "landmark_covariance": self._covariance[3:, 3:]}

    @classmethod
    def recalled(cls, arrays: Mapping[str, NDArray[Any]]) -> LandmarkMap:
        """Make the landmarks that `memory` returned, not yet seen again.

        Raises:
            ValueError: An array has another shape, or holds what cannot be.
        """
        about, covariance = (np.asarray(arrays[name], float) for name in ("landmarks", "landmark_covariance"))
        n = len(about)
        right = about.shape == (n, 4) and covariance.shape == (2 * n, 2 * n) and bool((about[:, 2:] > 0.0).all())
        if not (right and np.isfinite(about).all() and np.isfinite(covariance).all()):
            raise ValueError("landmarks that are no circles with a covariance")
        made = cls()._with(np.append(np.zeros(3), about[:, :2]), np.pad(covariance, ((3, 0), (3, 0))))
        made._radii, made._hits, made.last_s = about[:, 2], about[:, 3], np.full(n, -math.inf)
        return made

    def begun_anew(self, sigma: tuple[float, float, float]) -> LandmarkMap:
        """Return the landmarks for a robot whose start is off from their frame: x, y (m), theta (rad).

        They are the frame now. How they may all be shifted or turned together is the robot's doubt, not theirs: it is
        projected out of their covariance, and what is left says how well they lie relative to each other.
        """
        x, y = self._state[3::2], self._state[4::2]
        together = np.zeros((len(self._state) - 3, 3))
        together[::2, 0] = together[1::2, 1] = 1.0
        together[::2, 2], together[1::2, 2] = y.mean() - y, x - x.mean()
        apart = np.eye(len(together)) - together @ np.linalg.pinv(together)
        values, axes = np.linalg.eigh(apart @ self._covariance[3:, 3:] @ apart)
        doubt = np.diag(np.square(np.append(sigma, np.zeros(len(together)))))
        doubt[3:, 3:] = (axes * np.maximum(values, 0.0)) @ axes.T
        after = self._with(np.append(np.zeros(3), self._state[3:]), doubt)
        after._radii, after._hits, after.last_s = self._radii, self._hits, np.full(len(x), -math.inf)
        return after

    def pose(self, odometry: Pose) -> Pose:
        """Return the pose of the robot whose odometry says `odometry`."""
        x, y, theta = self.error
        return Pose(odometry.x - x, odometry.y - y, wrap(odometry.theta - theta))

    def drift(self, variance: NDArray[np.float64]) -> None:
        """Add to the variance of the odometry's error; variance: Shape=(3,), x and y (m²), theta (rad²)."""
        self._covariance[range(3), range(3)] += variance

    def propagate(self, motion: tuple[float, float], noise: NDArray[np.float64]) -> None:
        """Move the error on with an odometry that integrates its own heading: an error there turns what it adds.

        With e = odometry - pose, e_xy grows by e_theta (-dy, dx) over a motion (dx, dy), besides the noise.

        Args:
            motion: What the odometry has moved by in its own frame (m).
            noise: Covariance of what is new in its error: x, y (m), theta (rad). Shape=(3, 3).
        """
        grow = np.array([[1.0, 0.0, -motion[1]], [0.0, 1.0, motion[0]], [0.0, 0.0, 1.0]])
        self._state[:3] = grow @ self._state[:3]
        self._covariance[:3] = grow @ self._covariance[:3]
        self._covariance[:, :3] = self._covariance[:, :3] @ grow.T
        self._covariance[:3, :3] += noise

    def compare(
        self, sighting: Sighting, odometry: Pose, candidate_m: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Compare a sighting with the landmarks within `candidate_m` (m) of it, as the kernel `compare` does."""
        args = (self._state, self._covariance, self._radii)
        away_m, squared, log_density = compare(*args, _floats(odometry), _outline(sighting), SIGMAS, candidate_m)
        return away_m, squared, log_density

    def corrected(self, landmark: int, sighting: Sighting, odometry: Pose, now_s: float) -> LandmarkMap:
        """Return the map after a sighting of a landmark."""
        radius = sighting.radius_m if sighting.whole else float(self._radii[landmark])
        args = (self._state, self._covariance, landmark, radius, _floats(odometry), _outline(sighting), SIGMAS)
        after = self._with(*correct(*args))
        after._radii, after._hits, after.last_s = self._radii.copy(), self._hits.copy(), self.last_s.copy()
        after.last_s[landmark] = now_s
        if sighting.whole:
            after._hits[landmark] += 1.0
            after._radii[landmark] += (sighting.radius_m - self._radii[landmark]) / after._hits[landmark]
        return after

    def extended(self, sighting: Sighting, odometry: Pose, now_s: float) -> LandmarkMap:
        """Return the map with one more landmark, a body that is seen whole."""
        after = self._with(*start(self._state, self._covariance, _floats(odometry), _outline(sighting), SIGMAS))
        after._radii, after._hits = np.append(self._radii, sighting.radius_m), np.append(self._hits, 1.0)
        after.last_s = np.append(self.last_s, now_s)
        return after

    def _with(self, state: NDArray[np.float64], covariance: NDArray[np.float64]) -> LandmarkMap:
        other = LandmarkMap()
        other._state, other._covariance = state, covariance
        return other


def _floats(pose: Pose) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.theta


def _outline(sighting: Sighting) -> Outline:
    right = math.nan if sighting.right is None else sighting.right
    left = math.nan if sighting.left is None else sighting.left
    return right, left, sighting.near_m, sighting.width, sighting.radius_m, sighting.sigma_m
