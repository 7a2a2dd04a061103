"""Orientation functions that a cost may call, on (w, x, y, z) quaternions."""

from __future__ import annotations

import numpy as np

from coral.contact.cost_program.arithmetic import components, negative, total
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import number, pointwise, root, scalar
from coral.contact.cost_program.values import Value, Vec

Quat = tuple[Value, Value, Value, Value]
"""Four numbers (w, x, y, z)."""


def _read(meter: Meter, value: Value) -> Quat:
    items = components(meter, value, "a quaternion")
    if len(items) != 4:
        raise meter.fault("wrong_size", f"a quaternion has 4 components, not {len(items)}")
    return items[0], items[1], items[2], items[3]


def quat_angle(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the angle between two orientations, rad, 0 to pi; unlike an arc cosine it is smooth at 0."""
    w, x, y, z = _product(meter, _read(meter, b), _conjugate(meter, _read(meter, a)))
    sine = root(meter, number(meter, total(meter, tuple(scalar(meter, "*", v, v) for v in (x, y, z)))))
    meter.made(2)
    cosine = pointwise(meter, np.abs, number(meter, w))
    return scalar(meter, "*", 2.0, pointwise(meter, np.arctan2, sine, cosine))


def quat_rotate(meter: Meter, q: Value, v: Value) -> Value:
    """Rotate a vector from body to world axes."""
    rows, items = _matrix(meter, _read(meter, q)), components(meter, v)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"a vector of 3 is rotated, not of {len(items)}")
    return Vec(
        tuple(total(meter, tuple(scalar(meter, "*", a, b) for a, b in zip(row, items, strict=True))) for row in rows)
    )


def quat_axis(meter: Meter, q: Value, axis: Value) -> Value:
    """Return the world direction of the body's axis 0 (x), 1 (y) or 2 (z)."""
    if not isinstance(axis, int) or not 0 <= axis <= 2:
        raise meter.fault("wrong_call", "quat_axis takes the axis as 0, 1 or 2")
    return Vec(tuple(row[axis] for row in _matrix(meter, _read(meter, q))))


def _conjugate(meter: Meter, q: Quat) -> Quat:
    w, x, y, z = q
    return w, negative(meter, x), negative(meter, y), negative(meter, z)


def _product(meter: Meter, a: Quat, b: Quat) -> Quat:
    def signed(signs: str, pairs: tuple[tuple[int, int], ...]) -> Value:
        terms = [scalar(meter, "*", a[i], b[j]) for i, j in pairs]
        found: Value = terms[0]
        for sign, term in zip(signs, terms[1:], strict=True):
            found = scalar(meter, sign, found, term)
        return found

    return (
        signed("---", ((0, 0), (1, 1), (2, 2), (3, 3))),
        signed("++-", ((0, 1), (1, 0), (2, 3), (3, 2))),
        signed("-++", ((0, 2), (1, 3), (2, 0), (3, 1))),
        signed("+-+", ((0, 3), (1, 2), (2, 1), (3, 0))),
    )


def _matrix(meter: Meter, q: Quat) -> list[list[Value]]:
    """Compute the rotation matrix of a unit quaternion, row by row."""
    w, x, y, z = q

    def twice(a: Value, b: Value) -> Value:
        return scalar(meter, "*", 2.0, scalar(meter, "*", a, b))

    def add(symbol: str, a: Value, b: Value) -> Value:
        return scalar(meter, symbol, a, b)

    xx, yy, zz = twice(x, x), twice(y, y), twice(z, z)
    xy, xz, yz, wx, wy, wz = twice(x, y), twice(x, z), twice(y, z), twice(w, x), twice(w, y), twice(w, z)
    return [
        [add("-", 1.0, add("+", yy, zz)), add("-", xy, wz), add("+", xz, wy)],
        [add("+", xy, wz), add("-", 1.0, add("+", xx, zz)), add("-", yz, wx)],
        [add("-", xz, wy), add("+", yz, wx), add("-", 1.0, add("+", xx, yy))],
    ]
