"""Hot loops of EKF-SLAM: a sighting placed in the world, compared with every landmark, and used to update the state.

The state is the error of the odometry (x, y, theta: odometry minus pose), then the centres of the landmarks (x, y) in
the world. A sighting at z in the body frame gives the residual r = p + R(theta) z - l of a landmark l. Its derivative
by (error, landmark) is [[-1, 0, dy, -1, 0], [0, -1, -dx, 0, -1]], where (dx, dy) = R(theta) z.

A sighting is the tuple (right, left, near_m, width, radius_m, sigma_m) of `Sighting`, NaN for an outline that is
hidden; sigmas are the six values of `landmark_map.SIGMAS`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Outline = tuple[float, float, float, float, float, float]
Sigmas = tuple[float, float, float, float, float, float]


@njit(cache=True)
def is_whole(outline: Outline) -> bool:
    """Check whether both outlines are seen."""
    return not (math.isnan(outline[0]) or math.isnan(outline[1]))


@njit(cache=True)
def place(
    heading: float, outline: Outline, radius_m: float, sigmas: Sigmas
) -> tuple[float, float, float, float, float]:
    """Return how far a body of this radius is from the robot, in the world's axes, and the covariance of that.

    Returns:
        dx, dy (m), and the entries xx, xy, yy of the covariance (m²).
    """
    right, left, near_m, width, _, sigma_m = outline
    distance = near_m + radius_m
    half, partial = math.asin(radius_m / distance), 0.0
    if is_whole(outline):
        bearing = 0.5 * (right + left)
    else:
        partial, half = sigmas[3], max(half, 0.5 * width)
        bearing = right + half if math.isnan(left) else left - half
    along = (sigma_m + sigmas[0] * radius_m + partial) ** 2
    across = (sigmas[1] + sigmas[2] * radius_m + partial) ** 2
    c, s = math.cos(heading + bearing), math.sin(heading + bearing)
    xx, xy, yy = c * c * along + s * s * across, c * s * (along - across), s * s * along + c * c * across
    return distance * c, distance * s, xx, xy, yy


@njit(cache=True)
def residual_covariance(
    covariance: NDArray[np.float64], k: int, dx: float, dy: float, noise: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the entries xx, xy, yy of a residual's covariance (m²); k is the landmark's place in the state."""
    p, sxx, sxy, syy = covariance, noise[0], noise[1], noise[2]
    # u = derivative of the residual's x, v = of its y; both have three entries that are not 0.
    iu, u = (0, 2, k), (-1.0, dy, -1.0)
    iv, v = (1, 2, k + 1), (-1.0, -dx, -1.0)
    for a in range(3):
        for b in range(3):
            sxx += u[a] * u[b] * p[iu[a], iu[b]]
            sxy += u[a] * v[b] * p[iu[a], iv[b]]
            syy += v[a] * v[b] * p[iv[a], iv[b]]
    return sxx, sxy, syy


@njit(cache=True)
def compare(
    state: NDArray[np.float64],
    covariance: NDArray[np.float64],
    radii: NDArray[np.float64],
    odometry: tuple[float, float, float],
    outline: Outline,
    sigmas: Sigmas,
    candidate_m: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Compare a sighting with every landmark.

    Returns:
        Distance to each landmark (m), its squared Mahalanobis distance (radius included) and the logarithm of the
        probability density of the sighting, in 1/m² for one seen in part and 1/m³ for a whole one, whose radius counts;
        inf and -inf for landmarks farther away than `candidate_m`. Shape=(N,) each.
    """
    n = len(radii)
    away, squared, density = np.empty(n), np.full(n, np.inf), np.full(n, -np.inf)
    x, y, heading = odometry[0] - state[0], odometry[1] - state[1], odometry[2] - state[2]
    whole = is_whole(outline)
    for j in range(n):
        k = 3 + 2 * j
        radius = outline[4] if whole else radii[j]
        dx, dy, xx, xy, yy = place(heading, outline, radius, sigmas)
        rx, ry = x + dx - state[k], y + dy - state[k + 1]
        away[j] = math.hypot(rx, ry)
        if away[j] >= candidate_m:
            continue
        sxx, sxy, syy = residual_covariance(covariance, k, dx, dy, (xx, xy, yy))
        det = sxx * syy - sxy * sxy
        squared[j] = (rx * rx * syy - 2.0 * rx * ry * sxy + ry * ry * sxx) / det
        density[j] = -0.5 * squared[j] - math.log(2.0 * math.pi * math.sqrt(det))
        if whole:
            spread = sigmas[4] + sigmas[5] * radii[j]
            unlike = (radius - radii[j]) / spread
            squared[j] += unlike * unlike
            density[j] -= 0.5 * unlike * unlike + math.log(spread * math.sqrt(2.0 * math.pi))
    return away, squared, density


@njit(cache=True)
def correct(
    state: NDArray[np.float64],
    covariance: NDArray[np.float64],
    landmark: int,
    radius_m: float,
    odometry: tuple[float, float, float],
    outline: Outline,
    sigmas: Sigmas,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return state and covariance after a sighting of a landmark (Kalman)."""
    size, k = len(state), 3 + 2 * landmark
    dx, dy, xx, xy, yy = place(odometry[2] - state[2], outline, radius_m, sigmas)
    rx, ry = odometry[0] - state[0] + dx - state[k], odometry[1] - state[1] + dy - state[k + 1]
    sxx, sxy, syy = residual_covariance(covariance, k, dx, dy, (xx, xy, yy))
    det = sxx * syy - sxy * sxy
    cross, gain = np.empty((2, size)), np.empty((2, size))
    after, better = np.empty(size), np.empty((size, size))
    for i in range(size):
        row = covariance[i]
        cross[0, i] = -row[0] + dy * row[2] - row[k]
        cross[1, i] = -row[1] - dx * row[2] - row[k + 1]
        gain[0, i] = (cross[0, i] * syy - cross[1, i] * sxy) / det
        gain[1, i] = (cross[1, i] * sxx - cross[0, i] * sxy) / det
        after[i] = state[i] - gain[0, i] * rx - gain[1, i] * ry
    for i in range(size):
        g0, g1 = gain[0, i], gain[1, i]
        for j in range(i + 1):
            better[i, j] = better[j, i] = covariance[i, j] - g0 * cross[0, j] - g1 * cross[1, j]
    return after, better


@njit(cache=True)
def start(
    state: NDArray[np.float64],
    covariance: NDArray[np.float64],
    odometry: tuple[float, float, float],
    outline: Outline,
    sigmas: Sigmas,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return state and covariance with one more landmark, where a whole sighting is."""
    size = len(state)
    dx, dy, xx, xy, yy = place(odometry[2] - state[2], outline, outline[4], sigmas)
    longer, larger = np.empty(size + 2), np.empty((size + 2, size + 2))
    longer[:size], larger[:size, :size] = state, covariance
    longer[size], longer[size + 1] = odometry[0] - state[0] + dx, odometry[1] - state[1] + dy
    for i in range(size):
        larger[size, i] = larger[i, size] = -covariance[0, i] + dy * covariance[2, i]
        larger[size + 1, i] = larger[i, size + 1] = -covariance[1, i] - dx * covariance[2, i]
    larger[size, size] = -larger[size, 0] + dy * larger[size, 2] + xx
    larger[size, size + 1] = larger[size + 1, size] = -larger[size, 1] - dx * larger[size, 2] + xy
    larger[size + 1, size + 1] = -larger[size + 1, 1] - dx * larger[size + 1, 2] + yy
    return longer, larger
