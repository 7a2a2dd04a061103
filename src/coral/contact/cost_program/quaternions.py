"""Quaternion arithmetic for costs, and the guard against mixing up the two component orders.

Quantities of the state are (w, x, y, z). PyBullet's functions and the `..._ori` names of the paper are (x, y, z, w).
"""

from __future__ import annotations

from typing import cast

import numpy as np

from coral.contact.cost_program.arithmetic import binary, components, negative, total
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.scalars import number, pointwise, root, scalar, where
from coral.contact.cost_program.values import Value, Vec

ORDERS = ("wxyz", "xyzw")
Quat = tuple[Value, Value, Value, Value]
"""Four numbers (w, x, y, z)."""


def read_quat(meter: Meter, value: Value, order: str) -> Quat:
    """Convert a quaternion argument to (w, x, y, z).

    Args:
        meter: The evaluation.
        value: The argument.
        order: Order that the function takes, "wxyz" or "xyzw".

    Raises:
        CostError: It is not a vector of four, or is known to have the other order.
    """
    items = components(meter, value, "a quaternion")
    if len(items) != 4:
        raise meter.fault("wrong_size", f"a quaternion has 4 components, not {len(items)}")
    if isinstance(value, Vec) and value.order in ORDERS and value.order != order:
        hint = (
            "PyBullet's functions take (x, y, z, w): read NAME_ori instead of NAME_quat"
            if order == "xyzw"
            else "this function takes (w, x, y, z): read NAME_quat instead of NAME_ori or an answer of PyBullet"
        )
        raise meter.fault("quaternion_order", hint)
    if order == "wxyz":
        return items[0], items[1], items[2], items[3]
    return items[3], items[0], items[1], items[2]


def write_quat(q: Quat, order: str) -> Vec:
    """Convert a quaternion to a value of the program, in the order asked for."""
    w, x, y, z = q
    return Vec((w, x, y, z) if order == "wxyz" else (x, y, z, w), order=order)


def conjugate(meter: Meter, q: Quat) -> Quat:
    """Invert a unit quaternion."""
    w, x, y, z = q
    return w, negative(meter, x), negative(meter, y), negative(meter, z)


def product(meter: Meter, a: Quat, b: Quat) -> Quat:
    """Compose two rotations: `b` followed by `a`."""

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


def difference(meter: Meter, start: Quat, end: Quat) -> Quat:
    """Compute the shorter rotation from `start` to `end`: end * start^-1, with w >= 0."""
    along = total(meter, tuple(scalar(meter, "*", a, b) for a, b in zip(start, end, strict=True)))
    opposite = scalar(meter, "<", along, 0.0)
    if isinstance(opposite, np.ndarray):
        flipped: tuple[Value, ...] = tuple(where(meter, cast(Mask, opposite), negative(meter, x), x) for x in end)
    else:
        flipped = tuple(negative(meter, x) if opposite else x for x in end)
    w, x, y, z = flipped
    return product(meter, (w, x, y, z), conjugate(meter, start))


def angle(meter: Meter, a: Quat, b: Quat) -> Value:
    """Compute the angle between two orientations, rad, 0 to pi; unlike an arc cosine it is smooth at 0."""
    w, x, y, z = product(meter, b, conjugate(meter, a))
    sine = root(meter, number(meter, total(meter, tuple(scalar(meter, "*", v, v) for v in (x, y, z)))))
    meter.made(2)
    cosine = pointwise(meter, np.abs, number(meter, w))
    return scalar(meter, "*", 2.0, pointwise(meter, np.arctan2, sine, cosine))


def matrix(meter: Meter, q: Quat) -> list[list[Value]]:
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


def rotate(meter: Meter, q: Quat, v: tuple[Value, ...]) -> Vec:
    """Rotate a vector from body to world axes."""
    return Vec(
        tuple(
            total(meter, tuple(scalar(meter, "*", a, b) for a, b in zip(row, v, strict=True)))
            for row in matrix(meter, q)
        )
    )


def euler(meter: Meter, q: Quat) -> Vec:
    """Compute roll, pitch and yaw about the fixed x, y and z axes, rad."""
    rows = matrix(meter, q)
    meter.made(6)

    def arctan2(y: Value, x: Value) -> Value:
        return pointwise(meter, np.arctan2, number(meter, y), number(meter, x))

    sine = pointwise(meter, lambda x: np.clip(x, -1.0, 1.0), number(meter, negative(meter, rows[2][0])))
    return Vec((arctan2(rows[2][1], rows[2][2]), pointwise(meter, np.arcsin, sine), arctan2(rows[1][0], rows[0][0])))


def normalised(meter: Meter, q: Quat) -> Quat:
    """Scale the quaternion to length 1."""
    length = root(meter, number(meter, total(meter, tuple(scalar(meter, "*", x, x) for x in q))))
    w, x, y, z = (binary(meter, "/", item, length) for item in q)
    return w, x, y, z
