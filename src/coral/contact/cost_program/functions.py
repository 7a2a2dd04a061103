"""Functions of numbers and vectors: a part of `math` and `numpy`, and a few of our own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.arithmetic import binary, components, elementwise, norm, total
from coral.contact.cost_program.arrays import to_float, whole
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.scalars import (
    both,
    chosen,
    either,
    no_truth,
    number,
    pointwise,
    scalar,
    truth,
    where,
)
from coral.contact.cost_program.values import Number, Partial, Seq, Value, Vec, entries, kind

Call = Callable[..., Value]
"""Takes the meter, then the arguments of the program."""


def of_one(function: Callable[..., Any]) -> Call:
    """Make a function that applies NumPy's function of one number to every entry."""

    def call(meter: Meter, x: Value, /) -> Value:
        def apply(item: Value) -> Number:
            meter.made()
            meter.spend()
            return pointwise(meter, function, no_truth(meter, item))

        return elementwise(meter, apply, x)

    return call


def of_two(function: Callable[..., Any]) -> Call:
    """Make a function that applies NumPy's function of two numbers to every pair of entries."""

    def call(meter: Meter, x1: Value, x2: Value, /) -> Value:
        def apply(x: Value, y: Value) -> Number:
            meter.made()
            meter.spend()
            return pointwise(meter, function, no_truth(meter, x), no_truth(meter, y))

        return elementwise(meter, apply, x1, x2)

    return call


MAXIMUM, MINIMUM, ABS, EXP = of_two(np.maximum), of_two(np.minimum), of_one(np.abs), of_one(np.exp)


def of_math(function: Callable[..., Any]) -> Call:
    """Make a function of `math`, which raises where NumPy gives nan or infinity."""

    def call(meter: Meter, x: Value, /) -> Value:
        meter.made()
        meter.spend()
        given = np.asarray(number(meter, x), dtype=np.float64)
        found = function(given)
        if not np.isfinite(found).all():
            lost = ~np.isfinite(found) & ~(np.isnan(given) | (np.isinf(given) & ~np.isnan(found)))
            meter.refuse_where(
                lost, "not_finite", "math raises an exception here in some state; guard the argument with max and min"
            )
        return meter.as_plain(cast(Number, found)) if isinstance(x, np.ndarray) else float(found)

    return call


def whole_by(function: Callable[..., Any]) -> Call:
    """Make math.floor, math.ceil or Python's round, which give whole numbers."""

    def call(meter: Meter, x: Value, /) -> Value:
        meter.spend()
        if any(x is other for other in meter.zero_axes):
            raise meter.fault("wrong_type", "np.where makes an array here; write float(...) around it")
        return whole(meter, function, no_truth(meter, x))

    return call


def clip(meter: Meter, a: Value, a_min: Value, a_max: Value) -> Value:
    """Clip the value to two bounds, either of which may be None."""
    if a_min is not None:
        a = MAXIMUM(meter, a, a_min)
    if a_max is not None:
        a = MINIMUM(meter, a, a_max)
    return elementwise(meter, lambda x: no_truth(meter, x), a)


def clip01(meter: Meter, x: Value) -> Value:
    """Clip the value to [0, 1]."""
    return clip(meter, x, 0.0, 1.0)


def sigmoid(meter: Meter, x: Value) -> Value:
    """Compute 1 / (1 + exp(-x)) without overflow."""
    half = binary(meter, "*", 0.5, of_one(np.tanh)(meter, binary(meter, "*", 0.5, x)))
    return binary(meter, "+", 0.5, half)


def near(meter: Meter, distance: Value, scale: Value) -> Value:
    """Compute exp(-(distance / scale)^2): 1 at 0, almost 0 beyond twice the scale."""
    ratio = binary(meter, "/", distance, scale)
    return EXP(meter, binary(meter, "*", -1.0, binary(meter, "*", ratio, ratio)))


def select(meter: Meter, condition: Value, x: Value, y: Value, /) -> Value:
    """Evaluate np.where with three arguments."""

    def choose(condition: Value, x: Value, y: Value) -> Value:
        meter.spend()
        met = truth(meter, condition)
        if isinstance(met, np.ndarray) or isinstance(x, np.ndarray) or isinstance(y, np.ndarray):
            return chosen(meter, np.atleast_2d(np.asarray(met, dtype=np.bool_)), x, y)
        return cast(Number, np.where(met, cast(float, x), cast(float, y)).item())

    found = elementwise(meter, choose, condition, x, y)
    if not isinstance(found, Vec):  # NumPy makes an array without axes, which `+=` would change under all its names
        found = np.atleast_2d(cast(float, found))
        meter.zero_axes.append(found)
    return found


def cross(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the cross product of two vectors of length 3."""
    left, right = components(meter, a), components(meter, b)
    if len(left) != 3 or len(right) != 3:
        raise meter.fault("wrong_size", f"cross takes two vectors of 3, not of {len(left)} and {len(right)}")

    def minor(i: int, j: int) -> Value:
        return scalar(meter, "-", scalar(meter, "*", left[i], right[j]), scalar(meter, "*", left[j], right[i]))

    return Vec((minor(1, 2), minor(2, 0), minor(0, 1)))


def dist(meter: Meter, p: Value, q: Value, /) -> Value:
    """Compute the distance between two points, m."""
    if len(components(meter, p)) != len(components(meter, q)):
        raise meter.fault("wrong_size", "two points have equally many coordinates")
    return norm(meter, binary(meter, "-", p, q))


def largest(meter: Meter, items: tuple[Value, ...], symbol: str) -> Value:
    """Evaluate Python's max (symbol ">") or min ("<"): the first of several equal ones."""
    found: Value = no_truth(meter, items[0])
    for item in items[1:]:
        better = scalar(meter, symbol, no_truth(meter, item), found)
        if isinstance(better, np.ndarray):
            found = where(meter, cast(Mask, better), item, found)
        else:
            found = item if better else found
    return found


def add_up(meter: Meter, iterable: Value, /, start: Value = 0) -> Value:
    """Evaluate Python's sum; an entry that is set in some states only counts as 0 in the others."""
    if not isinstance(iterable, Seq | Vec):
        raise meter.fault("wrong_type", f"sum takes a list, not {kind(iterable)}")
    found = start
    for item in entries(meter, iterable):
        if isinstance(item, Partial):
            item = where(meter, item.mask, item.value, 0.0)
        found = binary(meter, "+", found, item)
    return found


def fold_truth(name: str) -> Callable[[Meter, tuple[Value, ...]], bool | Mask]:
    """Make the reduction of truth values by "any" or "all"."""

    def fold(meter: Meter, items: tuple[Value, ...]) -> bool | Mask:
        found: bool | Mask = name == "all"
        for item in items:
            found = (both if name == "all" else either)(meter, found, truth(meter, item))
        return found

    return fold


def _mean(meter: Meter, items: tuple[Value, ...]) -> Value:
    return scalar(meter, "/", total(meter, items), len(items))


def _most(function: Call) -> Callable[[Meter, tuple[Value, ...]], Value]:
    def fold(meter: Meter, items: tuple[Value, ...]) -> Value:
        found: Value = no_truth(meter, items[0])
        for item in items[1:]:
            found = function(meter, found, item)
        return found

    return fold


FOLDS: dict[str, Callable[[Meter, tuple[Value, ...]], Value]] = {
    "sum": total,
    "mean": _mean,
    "max": _most(MAXIMUM),
    "min": _most(MINIMUM),
    "any": fold_truth("any"),
    "all": fold_truth("all"),
}


def reduction(name: str) -> Call:
    """Make np.sum, np.mean, np.max, np.min, np.any or np.all."""

    def call(meter: Meter, a: Value) -> Value:
        return FOLDS[name](meter, a.items if isinstance(a, Vec) else (a,))

    return call


def length(meter: Meter, x: Value) -> Value:
    """Evaluate np.linalg.norm: the length of a vector, or the size of a number."""
    return norm(meter, x) if isinstance(x, Vec) else to_float(meter, ABS(meter, x))
