"""Motion of an object on a hinge or a slide: its pose from the joint's position, and back."""

from __future__ import annotations

import numpy as np

from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, rotate
from coral.contact.scene.observation import Array, BodyState
from coral.contact.scene.shapes import Joint


def joint_axis(joint: Joint, pose: BodyState) -> Array:
    """Compute the joint's axis in the world, a unit vector, Shape=(3,)."""
    return rotate(pose.quaternion, np.asarray(joint.axis) / np.linalg.norm(joint.axis))


def joint_motion(joint: Joint, start: BodyState, body: BodyState) -> float:
    """Compute how far the joint has moved (rad or m) between two poses of its object, as near as it can."""
    axis = joint_axis(joint, start)
    if joint.kind == "slide":
        return float((body.position - start.position) @ axis)
    turn = multiply(body.quaternion, conjugate(start.quaternion))
    angle = 2.0 * np.arctan2(turn[1:] @ axis, turn[0])
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)


def joint_speed(joint: Joint, start: BodyState, body: BodyState) -> float:
    """Compute the joint's speed (rad/s or m/s) from the velocity of its object."""
    velocity = body.velocity if joint.kind == "slide" else body.angular_velocity
    return float(velocity @ joint_axis(joint, start))


def move_joint(joint: Joint, pose: BodyState, by: float) -> BodyState:
    """Compute the pose, at rest, that an object has after its joint has moved by `by` (rad or m)."""
    axis = joint_axis(joint, pose)
    if joint.kind == "slide":
        return BodyState(pose.position + by * axis, pose.quaternion)
    turn = from_rotvec(axis * by)
    arm = rotate(pose.quaternion, np.asarray(joint.point))
    return BodyState(pose.position + arm - rotate(turn, arm), multiply(turn, pose.quaternion))
