"""Functions of numbers and vectors: a part of Python, `math` and `numpy`, and a few of our own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from coral.contact.cost_program.arithmetic import (
    apply,
    as_vector,
    binary,
    both,
    components,
    no_truth,
    norm,
    numeric,
    prepare,
    stack,
    total,
    truth,
    where,
)
from coral.contact.cost_program.limits import MOST_ITEMS, Mask, Meter
from coral.contact.cost_program.values import Array, Builtin, Partial, Value, entries, is_number, is_vector, kind

Call = Callable[..., Value]
"""Takes the meter, then the arguments of the program."""


def of_one(function: Callable[..., Any]) -> Call:
    """Make a function that applies NumPy's function of one number to every entry."""

    def call(meter: Meter, x: Value, /) -> Value:
        return apply(meter, function, x)

    return call


def of_two(function: Callable[..., Any]) -> Call:
    """Make a function that applies NumPy's function of two numbers to every pair of entries."""

    def call(meter: Meter, x1: Value, x2: Value, /) -> Value:
        return apply(meter, function, x1, x2)

    return call


def to_float(meter: Meter, value: Value = 0.0, /) -> Value:
    """Make a decimal: a number stays one, a truth value becomes 0 or 1, "inf" becomes infinity."""
    if isinstance(value, str) and value in ("inf", "-inf"):
        return float(value)
    if not is_number(value):
        raise meter.fault("wrong_type", f"float takes a number, not {kind(value)}")
    found = numeric(meter, value)
    return found if isinstance(found, np.ndarray) else float(found)


def absolute(meter: Meter, x: Value, /) -> Value:
    """Evaluate Python's `abs`."""
    if isinstance(x, list | tuple):
        raise meter.fault("wrong_type", f"abs takes a number or an array, not {kind(x)}; use np.abs")
    return abs(x) if isinstance(x, int) and not isinstance(x, bool) else apply(meter, np.abs, x)


def clip(meter: Meter, a: Value, a_min: Value, a_max: Value) -> Value:
    """Clip the value to two bounds, either of which may be None."""
    if a_min is not None:
        a = apply(meter, np.maximum, a, a_min)
    if a_max is not None:
        a = apply(meter, np.minimum, a, a_max)
    return no_truth(meter, as_vector(meter, a))


def clip01(meter: Meter, x: Value) -> Value:
    """Clip the value to [0, 1]."""
    return clip(meter, x, 0.0, 1.0)


def sigmoid(meter: Meter, x: Value) -> Value:
    """Compute 1 / (1 + exp(-x)) without overflow."""
    return apply(meter, lambda value: 0.5 + 0.5 * np.tanh(0.5 * value), x)


def near(meter: Meter, distance: Value, scale: Value) -> Value:
    """Compute exp(-(distance / scale)^2): 1 at 0, almost 0 beyond twice the scale."""
    return apply(meter, lambda d, s: np.exp(-np.square(d / s)), distance, scale)


def select(meter: Meter, condition: Value, x: Value, y: Value, /) -> Value:
    """Evaluate np.where with three arguments."""
    given = as_vector(meter, condition)
    met = given != 0 if is_vector(given) else truth(meter, given)
    a, b = as_vector(meter, x), as_vector(meter, y)
    if isinstance(met, bool) and not isinstance(a, np.ndarray) and not isinstance(b, np.ndarray):
        return a if met else b
    return where(meter, np.atleast_2d(np.asarray(met)), a, b)


def cross(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the cross product of two vectors of length 3."""
    u, v = components(meter, a), components(meter, b)
    if len(u) != 3 or len(v) != 3:
        raise meter.fault("wrong_size", f"cross takes two vectors of 3, not of {len(u)} and {len(v)}")
    return stack(meter, [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


def dist(meter: Meter, p: Value, q: Value, /) -> Value:
    """Compute the distance between two points, m."""
    u, v = components(meter, p), components(meter, q)
    if len(u) != len(v):
        raise meter.fault("wrong_size", "two points have equally many coordinates")
    return norm(meter, binary(meter, "-", u, v))


def length(meter: Meter, x: Value) -> Value:
    """Evaluate np.linalg.norm: the length of a vector, or the size of a number."""
    return norm(meter, x) if is_vector(x) else apply(meter, np.abs, x)


def largest(meter: Meter, items: Sequence[Value], symbol: str) -> Value:
    """Evaluate Python's max (symbol ">") or min ("<"): the first of several equal ones."""
    found: Value = no_truth(meter, items[0])
    for item in items[1:]:
        better = truth(meter, binary(meter, symbol, no_truth(meter, item), found))
        if not isinstance(better, bool):
            found = where(meter, better, item, found)
        elif better:
            found = item
    return found


def add_up(meter: Meter, iterable: Value, /, start: Value = 0) -> Value:
    """Evaluate Python's sum; an entry that is set in some states only counts as 0 in the others."""
    found = start
    for item in entries(meter, iterable):
        if isinstance(item, Partial):
            item = where(meter, item.mask, item.value, 0.0)
        found = binary(meter, "+", found, item)
    return found


def fold_truth(name: str, meter: Meter, items: Sequence[Value]) -> bool | Mask:
    """Reduce truth values by "any" or "all"."""
    found: bool | Mask = name == "all"
    for item in items:
        met = truth(meter, item)
        found = both(meter, found, met) if name == "all" else np.logical_or(found, met)
    return bool(found) if np.ndim(found) == 0 else found


def reduction(name: str) -> Call:
    """Make np.sum, np.mean, np.max, np.min, np.any or np.all."""

    def call(meter: Meter, a: Value) -> Value:
        if name in ("any", "all"):
            return fold_truth(name, meter, list(a) if is_vector(a) else [a])
        if not is_vector(a):
            return numeric(meter, a) if name in ("sum", "mean") else no_truth(meter, a)
        if name in ("sum", "mean"):
            found = total(meter, components(meter, a))
            return found if name == "sum" else found / len(a)
        prepare(meter, a)
        return (np.max if name == "max" else np.min)(np.asarray(no_truth(meter, a)), axis=0)

    return call


def array(meter: Meter, value: Value, dtype: Value = None) -> Value:
    """Make a vector of a list, or return the array itself; `dtype=float` makes decimals."""
    if dtype is None:
        return value
    if not (isinstance(dtype, Builtin) and dtype.name == "float"):
        raise meter.fault("wrong_call", "arrays hold float64 only; leave dtype out or write dtype=float")
    return numeric(meter, value)


def copied(meter: Meter, a: Value) -> Value:
    """Return the array: it cannot be changed."""
    return a


def filled_with(fill: float) -> Call:
    """Make np.zeros or np.ones."""

    def call(meter: Meter, shape: Value) -> Value:
        if isinstance(shape, int) and not isinstance(shape, bool) and 0 < shape <= MOST_ITEMS:
            return np.full((shape, 1, 1), fill)
        raise meter.fault("not_fixed", f"a size is a whole number from 1 to {MOST_ITEMS}; an array has one axis")

    return call


def concatenated(meter: Meter, arrays: Value) -> Value:
    """Put vectors one after another."""
    if not isinstance(arrays, list | tuple) or not arrays:
        raise meter.fault("wrong_call", f"this takes a list of arrays, not {kind(arrays)}")
    return stack(meter, [item for part in arrays for item in components(meter, part)])


def appended(meter: Meter, a: Value, values: Value) -> Value:
    """Put a number or a vector at the end of a vector."""
    more = as_vector(meter, values)
    return concatenated(meter, [a, more if is_vector(more) else [more]])


def quat_angle(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the angle between two orientations, rad, 0 to pi; unlike an arc cosine it is smooth at 0."""
    (bw, bx, by, bz), (aw, ax, ay, az) = _quaternion(meter, b), _quaternion(meter, a)
    meter.made(14)
    w = bw * aw + bx * ax + by * ay + bz * az
    x = bx * aw - bw * ax - by * az + bz * ay
    y = bx * az - bw * ay + by * aw - bz * ax
    z = by * ax - (bw * az + bx * ay) + bz * aw
    return np.asarray(2.0 * np.arctan2(np.sqrt(x * x + y * y + z * z), np.abs(w)))


def quat_rotate(meter: Meter, q: Value, v: Value) -> Value:
    """Rotate a vector from body to world axes."""
    rows, vector = _matrix(meter, _quaternion(meter, q)), components(meter, v)
    if len(vector) != 3:
        raise meter.fault("wrong_size", f"a vector of 3 is rotated, not of {len(vector)}")
    x, y, z = vector
    return stack(meter, [row[0] * x + row[1] * y + row[2] * z for row in rows])


def quat_axis(meter: Meter, q: Value, axis: Value) -> Value:
    """Return the world direction of the body's axis 0 (x), 1 (y) or 2 (z)."""
    if not isinstance(axis, int) or not 0 <= axis <= 2:
        raise meter.fault("wrong_call", "quat_axis takes the axis as 0, 1 or 2")
    return stack(meter, [row[axis] for row in _matrix(meter, _quaternion(meter, q))])


def _quaternion(meter: Meter, value: Value) -> Array:
    found = components(meter, value, "a quaternion")
    if len(found) != 4:
        raise meter.fault("wrong_size", f"a quaternion has 4 components, not {len(found)}")
    return found


def _matrix(meter: Meter, q: Array) -> list[list[Array]]:
    """Compute the rotation matrix of a unit quaternion, row by row."""
    meter.made(21)
    w, x, y, z = q
    return [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
