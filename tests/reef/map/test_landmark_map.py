"""Gaussian map of landmarks: kernels against NumPy twins, and what a sighting does to the pose."""

import math
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.map.landmark_map import (
    ACROSS_SIGMA_M,
    ACROSS_SIGMA_RADIUS,
    PARTIAL_SIGMA_M,
    RADIUS_SIGMA_M,
    RADIUS_SIGMA_RADIUS,
    RANGE_SIGMA_RADIUS,
    LandmarkMap,
)
from coral.reef.map.landmarks import Sighting
from coral.reef.world.geometry import Pose

ODOMETRY = Pose(1.0, 2.0, 0.3)


def whole(bearing, near=2.0, half=0.1):
    return Sighting(bearing - half, bearing + half, near, 2.0 * half)


RIGHT_HALF = Sighting(0.1, None, 2.0, 0.15)
LEFT_HALF = Sighting(None, 0.4, 1.5, 0.15)
DOUBTED = replace(whole(0.2), sigma_m=0.4)


def surveyed():
    """Map with three landmarks and a long way behind it."""
    made = LandmarkMap()
    made.drift(np.array([0.02, 0.03, 0.002]))
    for k, bearing in enumerate((-0.5, 0.1, 0.6)):
        made = made.extended(whole(bearing, near=1.5 + 0.5 * k), ODOMETRY, 1.0)
        made.drift(np.array([0.01, 0.01, 0.001]))
    return made.corrected(1, whole(0.15, near=2.1), ODOMETRY, 2.0)


def placed(sighting, pose, radius_m):
    """Twin: place in the world, derivative by the odometry's error, covariance. Shapes (2,), (2, 3), (2, 2)."""
    distance = sighting.near_m + radius_m
    half = max(math.asin(radius_m / distance), 0.0 if sighting.whole else 0.5 * sighting.width)
    right = sighting.left - 2.0 * half if sighting.right is None else sighting.right
    bearing = right + half if sighting.left is None else 0.5 * (right + sighting.left)
    partial = 0.0 if sighting.whole else PARTIAL_SIGMA_M
    along = sighting.sigma_m + RANGE_SIGMA_RADIUS * radius_m + partial
    across = ACROSS_SIGMA_M + ACROSS_SIGMA_RADIUS * radius_m + partial
    c, s = math.cos(pose.theta + bearing), math.sin(pose.theta + bearing)
    turn, dx, dy = np.array([[c, -s], [s, c]]), distance * c, distance * s
    jacobian = np.array([[-1.0, 0.0, dy], [0.0, -1.0, -dx]])
    return np.array([pose.x + dx, pose.y + dy]), jacobian, turn @ np.diag([along**2, across**2]) @ turn.T


def innovation(before, landmark, sighting):
    """Twin: residual, its derivative by the whole state, its covariance, and the radius taken."""
    radius = sighting.radius_m if sighting.whole else before._radii[landmark]
    here, by_error, noise = placed(sighting, before.pose(ODOMETRY), radius)
    jacobian = np.zeros((2, len(before._state)))
    jacobian[:, :3], jacobian[:, 3 + 2 * landmark : 5 + 2 * landmark] = by_error, -np.eye(2)
    covariance = jacobian @ before._covariance @ jacobian.T + noise
    return here - before.centres[landmark], jacobian, covariance, radius


@pytest.mark.parametrize("sighting", [whole(0.2), RIGHT_HALF, LEFT_HALF, DOUBTED])
def test_comparison_equals_its_twin(sighting):
    before = surveyed()
    away_m, squared_m, log_density = before.compare(sighting, ODOMETRY, 10.0)
    for k in range(3):
        residual, _, covariance, radius = innovation(before, k, sighting)
        squared = residual @ np.linalg.solve(covariance, residual)
        density = -0.5 * squared - math.log(2.0 * math.pi * math.sqrt(np.linalg.det(covariance)))
        if sighting.whole:
            spread = RADIUS_SIGMA_M + RADIUS_SIGMA_RADIUS * before._radii[k]
            unlike = (radius - before._radii[k]) / spread
            squared += unlike**2
            density -= 0.5 * unlike**2 + math.log(spread * math.sqrt(2.0 * math.pi))
        assert away_m[k] == pytest.approx(np.hypot(*residual))
        assert squared_m[k] == pytest.approx(squared)
        assert log_density[k] == pytest.approx(density)


def test_landmarks_far_away_are_not_compared():
    _, squared, log_density = surveyed().compare(whole(0.2), ODOMETRY, 0.7)
    assert np.isinf(squared).tolist() == np.isneginf(log_density).tolist() == [True, False, True]


@pytest.mark.parametrize("sighting", [whole(0.2), RIGHT_HALF, LEFT_HALF, DOUBTED])
def test_correction_is_the_kalman_update(sighting):
    before = surveyed()
    after = before.corrected(1, sighting, ODOMETRY, 5.0)
    residual, jacobian, covariance, _ = innovation(before, 1, sighting)
    gain = before._covariance @ jacobian.T @ np.linalg.inv(covariance)
    np.testing.assert_allclose(after._state, before._state - gain @ residual, atol=1e-12)
    np.testing.assert_allclose(after._covariance, before._covariance - gain @ covariance @ gain.T, atol=1e-12)
    np.testing.assert_array_equal(after._covariance, after._covariance.T)
    assert after.last_s.tolist() == [1.0, 5.0, 1.0]


def test_a_new_landmark_is_as_uncertain_as_the_pose_and_the_sighting():
    before, sighting = surveyed(), whole(-0.2)
    after = before.extended(sighting, ODOMETRY, 5.0)
    here, by_error, noise = placed(sighting, before.pose(ODOMETRY), sighting.radius_m)
    np.testing.assert_allclose(after.centres[3], here)
    np.testing.assert_allclose(after._covariance[9:, :9], by_error @ before._covariance[:3], atol=1e-15)
    np.testing.assert_allclose(after._covariance[9:, 9:], by_error @ before._covariance[:3, :3] @ by_error.T + noise)
    np.testing.assert_array_equal(after._covariance, after._covariance.T)


def test_maps_of_other_hypotheses_stay_as_they_are():
    before = surveyed()
    kept = before._state.copy(), before._covariance.copy(), before.last_s.copy(), before._radii.copy()
    before.corrected(0, whole(-0.5), ODOMETRY, 9.0).drift(np.ones(3))
    before.extended(whole(0.0), ODOMETRY, 9.0).drift(np.ones(3))
    for now, then in zip((before._state, before._covariance, before.last_s, before._radii), kept, strict=True):
        np.testing.assert_array_equal(now, then)


def test_a_radius_is_the_mean_of_whole_sightings():
    before = LandmarkMap().extended(whole(0.0, half=0.1), ODOMETRY, 0.0)
    after = before.corrected(0, whole(0.0, half=0.2), ODOMETRY, 1.0).corrected(0, RIGHT_HALF, ODOMETRY, 2.0)
    assert after._radii[0] == pytest.approx(0.5 * (whole(0.0, half=0.1).radius_m + whole(0.0, half=0.2).radius_m))


def test_a_wrong_heading_turns_what_the_odometry_adds():
    """Odometry that integrates along a heading wrong by e: the error it has after a way is that way, turned by e."""
    made = LandmarkMap()
    made._state[:3] = 0.1, -0.2, 0.01
    made._covariance[:3, :3] = np.diag([0.0, 0.0, 0.02**2])
    way = (3.0, 4.0)
    made.propagate(way, np.zeros((3, 3)))
    c, s = math.cos(0.01), math.sin(0.01)
    true = c * way[0] + s * way[1], -s * way[0] + c * way[1]  # the same way along the true heading
    assert made.error == pytest.approx((0.1 + way[0] - true[0], -0.2 + way[1] - true[1], 0.01), abs=1e-3)
    assert made.sigma == pytest.approx((0.08, 0.06, 0.02))


def test_noise_of_the_odometry_is_added_with_its_correlation():
    made = surveyed()
    before, noise = made._covariance.copy(), np.array([[0.02, 0.01, 0.0], [0.01, 0.03, 0.0], [0.0, 0.0, 0.001]])
    made.propagate((0.0, 0.0), noise)
    assert made._covariance[:3, :3] == pytest.approx(before[:3, :3] + noise)
    assert made._covariance[3:, 3:] == pytest.approx(before[3:, 3:])


def test_the_covariance_of_landmarks_moves_with_the_error():
    """Twin: the whole covariance by the whole Jacobian."""
    made = surveyed()
    jacobian = np.eye(len(made._state))
    jacobian[0, 2], jacobian[1, 2] = -0.7, 0.4
    twin = jacobian @ made._covariance @ jacobian.T
    made.propagate((0.4, 0.7), np.zeros((3, 3)))
    assert made._covariance == pytest.approx(twin)


def test_saved_landmarks_are_known_again():
    made = surveyed()
    again = LandmarkMap.recalled(made.memory())
    np.testing.assert_array_equal(again.centres, made.centres)
    np.testing.assert_array_equal(again._radii, made._radii)
    np.testing.assert_array_equal(again._covariance[3:, 3:], made._covariance[3:, 3:])
    assert (again.error, again.sigma, list(again.last_s)) == ((0, 0, 0), (0, 0, 0), [-math.inf] * 3)


@pytest.mark.parametrize(
    "broken",
    [
        {"landmarks": np.ones((3, 3))},
        {"landmarks": np.zeros((3, 4))},
        {"landmark_covariance": np.eye(4)},
        {"landmark_covariance": np.full((6, 6), np.nan)},
    ],
)
def test_what_are_no_landmarks_is_refused(broken):
    with pytest.raises(ValueError, match="landmarks"):
        LandmarkMap.recalled(surveyed().memory() | broken)


def test_a_new_start_is_the_robots_doubt_and_none_of_the_landmarks():
    before = surveyed()
    begun = before.begun_anew((1.0, 1.0, 0.2))
    own = begun._covariance[3:, 3:]
    assert begun.sigma == pytest.approx((1.0, 1.0, 0.2))
    assert np.abs(begun._covariance[:3, 3:]).max() == 0.0
    assert np.linalg.eigvalsh(own).min() > -1e-12
    x, y = before.centres.T
    for common in ([1.0, 0.0] * 3, [0.0, 1.0] * 3, np.stack([-y, x], axis=1).ravel()):
        assert np.dot(common, own @ common) == pytest.approx(0.0, abs=1e-9)
    apart = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0])  # how far two lie from each other is as doubtful as it was
    assert apart @ own @ apart > 0.2 * (apart @ before._covariance[3:, 3:] @ apart)


def test_landmarks_seen_again_move_the_robot_and_not_the_map():
    before = surveyed()
    after = before.begun_anew((1.0, 1.0, 0.2))
    off = Pose(ODOMETRY.x + 0.8, ODOMETRY.y - 0.6, ODOMETRY.theta)  # where the robot is said to be
    for k, (bearing, near) in enumerate(((-0.5, 1.5), (0.1, 2.0), (0.6, 2.5))):
        after = after.corrected(k, whole(bearing, near=near), off, 1.0)
    assert after.error == pytest.approx((0.8, -0.6, 0.0), abs=0.1)
    assert np.abs(after.centres - before.centres).max() < 0.1
