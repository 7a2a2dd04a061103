"""Rigid transforms as homogeneous matrices, Shape=(4, 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from coral.contact.scene.geometry import quaternion_of, rotation_of
from coral.contact.scene.observation import Array, BodyState


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
