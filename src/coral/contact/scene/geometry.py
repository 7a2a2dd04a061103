"""Rotations as unit quaternions (w, x, y, z), matrices and rotation vectors; rigid transforms, Shape=(4, 4).

Arrays may have leading batch axes.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from coral.contact.scene.observation import Array, BodyState


def rotation_of(quaternion: ArrayLike) -> Array:
    """Convert unit quaternions, Shape=(..., 4), to rotation matrices, Shape=(..., 3, 3)."""
    columns = [column_of(quaternion, k) for k in range(3)]
    rotation = np.empty((*columns[0].shape, 3))
    for k, column in enumerate(columns):
        rotation[..., k] = column
    return rotation


def column_of(quaternion: ArrayLike, k: int) -> Array:
    """Compute a column of the rotation matrices, Shape=(..., 3): the direction of axis k."""
    q = np.asarray(quaternion, dtype=float)
    i, j = (k + 1) % 3, (k + 2) % 3
    w, along, first, second = q[..., 0], q[..., 1 + k], q[..., 1 + i], q[..., 1 + j]
    column = np.empty((*w.shape, 3))
    column[..., k] = 1 - 2 * (first * first + second * second)
    column[..., i] = 2 * (along * first + w * second)
    column[..., j] = 2 * (along * second - w * first)
    return column


def quaternion_of(rotation: ArrayLike) -> Array:
    """Convert one rotation matrix, Shape=(3, 3), to a unit quaternion, Shape=(4,), w >= 0."""
    m = np.asarray(rotation, dtype=float)
    # The eigenvector of the largest eigenvalue is exact for a rotation and the nearest one otherwise.
    k = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    q: Array = np.linalg.eigh(k)[1][:, -1]
    return np.asarray(-q if q[0] < 0 else q)


def multiply(first: ArrayLike, second: ArrayLike) -> Array:
    """Multiply quaternions, Shape=(..., 4): `second` is applied first."""
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    aw, ax, ay, az = (a[..., k] for k in range(4))
    bw, bx, by, bz = (b[..., k] for k in range(4))
    w = aw * bw - ax * bx - ay * by - az * bz
    product = np.empty((*w.shape, 4))
    product[..., 0] = w
    product[..., 1] = aw * bx + ax * bw + ay * bz - az * by
    product[..., 2] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 3] = aw * bz + ax * by - ay * bx + az * bw
    return product


def conjugate(quaternion: ArrayLike) -> Array:
    """Invert unit quaternions, Shape=(..., 4)."""
    return np.asarray(np.asarray(quaternion, dtype=float) * np.array([1.0, -1.0, -1.0, -1.0]))


def rotate(quaternion: ArrayLike, vector: ArrayLike) -> Array:
    """Rotate vectors, Shape=(..., 3), by unit quaternions, Shape=(..., 4)."""
    q, v = np.asarray(quaternion, dtype=float), np.asarray(vector, dtype=float)
    axis = q[..., 1:]
    turn = 2.0 * cross(axis, v)
    return np.asarray(v + q[..., :1] * turn + cross(axis, turn))


def cross(a: Array, b: Array) -> Array:
    """Compute cross products, Shape=(..., 3); for single vectors NumPy's own takes several times as long."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x = ay * bz - az * by
    product = np.empty((*x.shape, 3))
    product[..., 0] = x
    product[..., 1] = az * bx - ax * bz
    product[..., 2] = ax * by - ay * bx
    return product


def from_rotvec(rotvec: ArrayLike) -> Array:
    """Convert rotation vectors (rad), Shape=(..., 3), to unit quaternions, Shape=(..., 4)."""
    v = np.asarray(rotvec, dtype=float)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), v * (0.5 * np.sinc(angle / (2 * np.pi)))], axis=-1)


def to_rotvec(quaternion: ArrayLike) -> Array:
    """Convert unit quaternions, Shape=(..., 4), to the shortest rotation vectors (rad), Shape=(..., 3)."""
    q = np.asarray(quaternion, dtype=float)
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    return np.asarray(q[..., 1:] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0))


def from_rpy_deg(rpy: ArrayLike) -> Array:
    """Convert roll, pitch, yaw in degrees, z-y-x, to a unit quaternion."""
    roll, pitch, yaw = np.radians(np.asarray(rpy, dtype=float))
    return multiply(from_rotvec([0, 0, yaw]), multiply(from_rotvec([0, pitch, 0]), from_rotvec([roll, 0, 0])))


def angle_between(first: ArrayLike, second: ArrayLike) -> Array:
    """Compute the angles (rad, 0 to pi) between orientations, Shape=(...)."""
    return np.asarray(np.linalg.norm(to_rotvec(multiply(conjugate(first), second)), axis=-1))


def rotation_about(axis: ArrayLike, angle: float) -> Array:
    """Make the rotation matrix, Shape=(3, 3), for `angle` (rad) about a unit axis."""
    return rotation_of(from_rotvec(np.asarray(axis) * angle))


def rotation_from_vector(rotvec: ArrayLike) -> Array:
    """Convert a rotation vector (rad) to a rotation matrix, Shape=(3, 3)."""
    return rotation_of(from_rotvec(rotvec))


def rotation_vector(rotation: ArrayLike) -> Array:
    """Convert one rotation matrix to a rotation vector (rad), Shape=(3,)."""
    return to_rotvec(quaternion_of(rotation))


def rotation_angle(first: ArrayLike, second: ArrayLike) -> float:
    """Compute the angle (rad, 0 to pi) between two rotation matrices."""
    return float(np.linalg.norm(rotation_vector(np.asarray(first).T @ second)))


def spread_rotations(n: int) -> Array:
    """Spread `n` rotation matrices evenly over all rotations. Shape=(n, 3, 3).

    Alexa, "Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3)" (CVPR 2022).
    """
    phi, psi = math.sqrt(2.0), 1.533751168755204288118041
    s = np.arange(n) + 0.5
    r, big_r = np.sqrt(s / n), np.sqrt(1.0 - s / n)
    a, b = 2 * math.pi * s / phi, 2 * math.pi * s / psi
    return rotation_of(np.stack([r * np.sin(a), r * np.cos(a), big_r * np.sin(b), big_r * np.cos(b)], -1))


def pose_matrix(rotation: ArrayLike, position: ArrayLike) -> Array:
    """Make the transform that rotates, Shape=(3, 3), and then translates, Shape=(3,) m."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation, position
    return transform


def inverse_transform(transform: Array) -> Array:
    """Invert a rigid transform."""
    turn = transform[:3, :3].T
    return pose_matrix(turn, -turn @ transform[:3, 3])


def body_to_matrix(body: BodyState) -> Array:
    """Return T_world_body of a body."""
    return pose_matrix(rotation_of(body.quaternion), body.position)


def matrix_to_body(transform: Array) -> BodyState:
    """Return the body at rest at a pose T_world_body."""
    return BodyState(transform[:3, 3], quaternion_of(transform[:3, :3]))
