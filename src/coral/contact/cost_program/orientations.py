"""Orientation functions that a cost may call, on (w, x, y, z) quaternions."""

from __future__ import annotations

from coral.contact.cost_program.arithmetic import components
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.quaternions import (
    angle,
    conjugate,
    euler,
    matrix,
    normalised,
    product,
    read_quat,
    rotate,
    write_quat,
)
from coral.contact.cost_program.values import Value, Vec


def quat_angle(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the angle between two orientations, rad."""
    return angle(meter, read_quat(meter, a, "wxyz"), read_quat(meter, b, "wxyz"))


def quat_rotate(meter: Meter, q: Value, v: Value) -> Value:
    """Rotate a vector from body to world axes."""
    return rotate(meter, read_quat(meter, q, "wxyz"), _three(meter, v))


def quat_axis(meter: Meter, q: Value, axis: Value) -> Value:
    """Return the world direction of the body's axis 0 (x), 1 (y) or 2 (z)."""
    if not isinstance(axis, int) or not 0 <= axis <= 2:
        raise meter.fault("wrong_call", "quat_axis takes the axis as 0, 1 or 2")
    return Vec(tuple(row[axis] for row in matrix(meter, read_quat(meter, q, "wxyz"))))


def quat_multiply(meter: Meter, a: Value, b: Value) -> Value:
    """Compose two rotations: `b` followed by `a`."""
    return write_quat(product(meter, read_quat(meter, a, "wxyz"), read_quat(meter, b, "wxyz")), "wxyz")


def quat_inverse(meter: Meter, q: Value) -> Value:
    """Invert a rotation."""
    return write_quat(conjugate(meter, read_quat(meter, q, "wxyz")), "wxyz")


def quat_matrix(meter: Meter, q: Value) -> Value:
    """Compute the rotation matrix, three rows."""
    return Vec(tuple(Vec(tuple(row)) for row in matrix(meter, read_quat(meter, q, "wxyz"))))


def quat_euler(meter: Meter, q: Value) -> Value:
    """Compute roll, pitch and yaw about the world's x, y and z axes, rad."""
    return euler(meter, normalised(meter, read_quat(meter, q, "wxyz")))


def _three(meter: Meter, value: Value) -> tuple[Value, ...]:
    items = components(meter, value)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"a vector of 3 is needed here, not of {len(items)}")
    return items
