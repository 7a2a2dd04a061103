"""Rotation matrices and rigid transforms: axis and angle, inverse, and an even spread over all orientations."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.geometry import from_rotvec, quaternion_of, rotation_of, to_rotvec

Array = NDArray[np.float64]


def about(axis: Array, angle: float) -> Array:
    """Rotation by `angle` (rad) about a unit axis. Shape=(3, 3)."""
    return rotation_of(from_rotvec(np.asarray(axis) * angle))


def vector(matrix: Array) -> Array:
    """Axis times angle (rad) of one rotation matrix. Shape=(3,)."""
    return np.asarray(to_rotvec(quaternion_of(matrix)))


def angle(first: Array, second: Array) -> float:
    """Angle (rad) between two rotation matrices."""
    return float(np.linalg.norm(vector(np.asarray(first).T @ second)))


def spread(n: int) -> Array:
    """`n` rotations spread evenly over all of them. Shape=(n, 3, 3).

    Alexa, "Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3)" (CVPR 2022).
    """
    phi, psi = math.sqrt(2.0), 1.533751168755204288118041
    s = np.arange(n) + 0.5
    r, big_r = np.sqrt(s / n), np.sqrt(1.0 - s / n)
    a, b = 2 * math.pi * s / phi, 2 * math.pi * s / psi
    return rotation_of(np.stack([r * np.sin(a), r * np.cos(a), big_r * np.sin(b), big_r * np.cos(b)], -1))


def pose(rotation: Array, position: Array) -> Array:
    """Homogeneous transform. Shape=(4, 4)."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation, position
    return transform


def inverse(transform: Array) -> Array:
    """Inverse of a rigid transform. Shape=(4, 4)."""
    turn = transform[:3, :3].T
    return pose(turn, -turn @ transform[:3, 3])


def from_vector(turn: Array) -> Array:
    """Rotation matrix of axis times angle (rad). Shape=(3, 3)."""
    return rotation_of(from_rotvec(turn))
