"""Statistics of vectors: variance, sorting, cumulative sums, interpolation."""

from __future__ import annotations

from itertools import pairwise
from typing import cast

import numpy as np

from coral.contact.cost_program.arithmetic import as_vector, binary, components, each, root, scalar, total, unary
from coral.contact.cost_program.functions import along, flat, select, with_kept_axes
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.values import Number, Seq, Value, Vec, is_matrix, is_one_of, kind


def variance(meter: Meter, a: Value, axis: Value = None, ddof: Value = 0, keepdims: Value = False) -> Value:
    """Compute the mean squared distance from the mean."""
    value = as_vector(meter, a)
    if not isinstance(ddof, int) or not 0 <= ddof <= 1:
        raise meter.fault("wrong_call", "ddof is 0 or 1")
    lines = along(meter, value, axis)
    if lines is None:
        found = _variance(meter, flat(meter, value), int(ddof))
    else:
        found = Vec(tuple(_variance(meter, flat(meter, line), int(ddof)) for line in lines))
    return with_kept_axes(meter, value, axis, keepdims, found)


def _variance(meter: Meter, items: tuple[Value, ...], ddof: int) -> Value:
    if len(items) <= ddof:
        raise meter.fault("wrong_size", f"the spread of {len(items)} numbers")
    mean = scalar(meter, "/", total(meter, items), len(items))
    gaps = [scalar(meter, "-", item, mean) for item in items]
    return scalar(meter, "/", total(meter, tuple(scalar(meter, "*", gap, gap) for gap in gaps)), len(items) - ddof)


def deviation(meter: Meter, a: Value, axis: Value = None, ddof: Value = 0, keepdims: Value = False) -> Value:
    """Compute the standard deviation."""
    return each(meter, lambda item: root(meter, item), variance(meter, a, axis, ddof, keepdims))


def average(meter: Meter, a: Value, axis: Value = None, weights: Value = None) -> Value:
    """Compute the mean of a vector, weighted or not."""
    items = flat(meter, a)
    if not is_one_of(axis, (None, 0, -1)) or is_matrix(as_vector(meter, a)):
        raise meter.fault("wrong_call", "average takes a vector; use mean along an axis")
    if weights is None:
        weights = Seq((1.0,) * len(items))
    scale = components(meter, weights)
    if len(scale) != len(items) or not items:
        raise meter.fault("wrong_size", f"{len(scale)} weights for {len(items)} numbers")
    summed = total(meter, tuple(scalar(meter, "*", x, w) for x, w in zip(items, scale, strict=True)))
    return scalar(meter, "/", summed, total(meter, scale))


def in_order(meter: Meter, items: tuple[Value, ...]) -> tuple[Value, ...]:
    """Sort numbers in ascending order, state by state."""
    numbers = [scalar(meter, "+", item, 0) for item in items]
    if not any(isinstance(item, np.ndarray) for item in numbers):
        return tuple(sorted(cast(list[float], numbers)))
    meter.made(2 * len(numbers))
    full = np.stack(np.broadcast_arrays(*(np.atleast_2d(np.asarray(item, dtype=np.float64)) for item in numbers)))
    return tuple(np.sort(full, axis=0))


def sorted_list(meter: Meter, iterable: Value, reverse: Value = False) -> Value:
    """Evaluate Python's sorted on numbers or on constant texts."""
    if not isinstance(reverse, bool):
        raise meter.fault("not_fixed", "reverse is True or False")
    items = entries(meter, iterable)
    if items and all(isinstance(item, str) for item in items):
        found: tuple[Value, ...] = tuple(sorted(str(item) for item in items))
    else:
        found = in_order(meter, items)
    return Seq(found[::-1] if reverse else found)


def sort(meter: Meter, a: Value) -> Value:
    """Evaluate np.sort on a vector."""
    return Vec(in_order(meter, components(meter, a)))


def median(meter: Meter, a: Value) -> Value:
    """Return the middle number, or the mean of the two middle ones."""
    items = in_order(meter, flat(meter, a))
    if not items:
        raise meter.fault("wrong_size", "median of nothing")
    half = len(items) // 2
    if len(items) % 2:
        return items[half]
    return scalar(meter, "/", scalar(meter, "+", items[half - 1], items[half]), 2.0)


def cumulated(meter: Meter, a: Value) -> Value:
    """Evaluate np.cumsum on a vector."""
    items = components(meter, a)
    found: list[Value] = []
    for item in items:
        found.append(scalar(meter, "+", found[-1], item) if found else item)
    return Vec(tuple(found))


def differences(meter: Meter, a: Value) -> Value:
    """Evaluate np.diff on a vector: each number minus the one before it."""
    items = components(meter, a)
    return Vec(tuple(binary(meter, "-", y, x) for x, y in pairwise(items)))


def interpolated(meter: Meter, x: Value, xp: Value, fp: Value) -> Value:
    """Evaluate np.interp: piecewise linear between constant points."""
    knots, heights = components(meter, xp), components(meter, fp)
    if not all(isinstance(item, int | float) for item in (*knots, *heights)):
        raise meter.fault("not_fixed", "the points of np.interp are constants; use np.clip and a straight line instead")
    if not knots or len(knots) != len(heights):
        raise meter.fault("wrong_size", f"{len(knots)} places and {len(heights)} values of np.interp do not match")
    places = np.array(knots, dtype=np.float64)
    values = np.array(heights, dtype=np.float64)

    def look_up(item: Number) -> Number:
        meter.made()
        return unary(lambda at: np.interp(at, places, values), item)

    return each(meter, look_up, x)


def chosen(meter: Meter, condlist: Value, choicelist: Value, default: Value = 0) -> Value:
    """Evaluate np.select: the choice of the first condition that holds."""
    conditions, choices = entries(meter, condlist), entries(meter, choicelist)
    if len(conditions) != len(choices) or not conditions:
        raise meter.fault("wrong_size", f"{len(conditions)} conditions and {len(choices)} choices do not match")
    found = default
    for condition, choice in zip(reversed(conditions), reversed(choices), strict=True):
        found = select(meter, condition, choice, found)
    return found


def _constant(meter: Meter, value: Value) -> float:
    if isinstance(value, int | float) and np.isfinite(value):
        return value
    raise meter.fault("not_fixed", f"this takes constant numbers, not {kind(value)}")


def arange(meter: Meter, *values: Value) -> Value:
    """Evaluate np.arange with constant arguments."""
    numbers = [_constant(meter, value) for value in values]
    if not 1 <= len(numbers) <= 3 or (len(numbers) == 3 and numbers[2] == 0):
        raise meter.fault("wrong_call", "arange takes one to three numbers, the step not 0")
    start, stop, step = (0, numbers[0], 1) if len(numbers) == 1 else (*numbers, 1)[:3]
    if (stop - start) / step > meter.cfg.items:
        raise meter.fault("memory", f"an array has at most {meter.cfg.items} entries")
    return Vec(tuple(np.arange(*numbers).tolist()))


def linspace(meter: Meter, start: Value, stop: Value, num: Value = 50) -> Value:
    """Evaluate np.linspace with constant arguments."""
    if not isinstance(num, int) or not 0 <= num <= meter.cfg.items:
        raise meter.fault("not_fixed", f"linspace takes a constant count up to {meter.cfg.items}")
    return Vec(tuple(np.linspace(_constant(meter, start), _constant(meter, stop), num).tolist()))


def hypotenuse(meter: Meter, *values: Value) -> Value:
    """Evaluate math.hypot with any number of arguments."""
    found: Value = 0.0
    for value in values:
        meter.made()
        a, b = scalar(meter, "+", found, 0.0), scalar(meter, "+", value, 0.0)
        found = np.hypot(a, b) if isinstance(a, np.ndarray) or isinstance(b, np.ndarray) else float(np.hypot(a, b))
    return found
