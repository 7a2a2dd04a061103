"""Reductions of arrays: sums, means, extremes and lengths of all entries or along an axis."""

from __future__ import annotations

import math
from collections.abc import Callable

from coral.contact.cost_program.arithmetic import components, norm, total
from coral.contact.cost_program.arrays import flat, to_float
from coral.contact.cost_program.functions import ABS, MAXIMUM, MINIMUM, Call
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.scalars import both, either, no_truth, number, scalar, truth
from coral.contact.cost_program.values import Value, Vec, depth, is_matrix, kind

Items = tuple[Value, ...]


def along(meter: Meter, value: Value, axis: Value) -> Items | None:
    """Return the lines of a matrix that a reduction over `axis` runs along; None means all entries together.

    Raises:
        CostError: The value has no such axis.
    """
    if axis is None:
        return None
    axes = depth(value)
    if not isinstance(axis, int) or isinstance(axis, bool) or not -axes <= axis < axes:
        raise meter.fault("wrong_size", f"{kind(value)} has no axis {axis}")
    if not isinstance(value, Vec) or axes == 1:
        return None
    if axis in (1, -1):
        return value.items
    return tuple(Vec(column) for column in zip(*(components(meter, row) for row in value.items), strict=True))


def fold_truth(meter: Meter, items: Items, name: str) -> bool | Mask:
    """Reduce truth values by any or all."""
    found: bool | Mask = name == "all"
    for item in items:
        found = (both if name == "all" else either)(meter, found, truth(meter, item))
    return found


def _mean(meter: Meter, items: Items) -> Value:
    return scalar(meter, "/", total(meter, items), len(items))


def _product(meter: Meter, items: Items) -> Value:
    found: Value = number(meter, items[0])
    for item in items[1:]:
        found = scalar(meter, "*", found, number(meter, item))
    return found


def _most(function: Call) -> Callable[[Meter, Items], Value]:
    def fold(meter: Meter, items: Items) -> Value:
        found: Value = no_truth(meter, items[0])
        for item in items[1:]:
            found = function(meter, found, item)
        return found

    return fold


FOLDS: dict[str, Callable[[Meter, Items], Value]] = {
    "sum": total,
    "mean": _mean,
    "prod": _product,
    "max": _most(MAXIMUM),
    "min": _most(MINIMUM),
    "any": lambda meter, items: fold_truth(meter, items, "any"),
    "all": lambda meter, items: fold_truth(meter, items, "all"),
}


def reduction(name: str) -> Call:
    """Make np.sum, np.mean, np.prod, np.max, np.min, np.any or np.all."""
    fold = FOLDS[name]

    def call(meter: Meter, a: Value, axis: Value = None, *, keepdims: Value = False) -> Value:
        return _reduced(meter, a, axis, keepdims, lambda line: fold(meter, flat(line)))

    return call


def linalg_norm(meter: Meter, x: Value, ord: Value = None, axis: Value = None, keepdims: Value = False) -> Value:
    """Evaluate np.linalg.norm: of a vector, of rows or columns of a matrix, and of a whole matrix without `ord`."""
    if isinstance(ord, bool) or not (ord is None or (isinstance(ord, int | float) and ord in (1, 2, math.inf))):
        raise meter.fault("wrong_call", "norm takes ord 1, 2 or np.inf")
    if ord is not None and depth(x) != 1 and (axis is None or depth(x) == 0):
        raise meter.fault("wrong_call", f"norm takes an ord for vectors, not for {kind(x)}; give it an axis")
    if not isinstance(x, Vec) and axis is None and keepdims is False:
        return to_float(meter, ABS(meter, x))

    def length(line: Value) -> Value:
        if ord in (None, 2):
            return norm(meter, Vec(flat(line)))
        sizes = flat(ABS(meter, line))
        return to_float(meter, FOLDS["sum" if ord == 1 else "max"](meter, sizes))

    return _reduced(meter, x, axis, keepdims, length)


def _reduced(meter: Meter, value: Value, axis: Value, keepdims: Value, fold: Callable[[Value], Value]) -> Value:
    if not isinstance(keepdims, bool):
        raise meter.fault("wrong_call", "keepdims is True or False")
    lines = along(meter, value, axis)
    found = fold(value) if lines is None else Vec(tuple(map(fold, lines)))
    if not keepdims or not isinstance(value, Vec):
        return found
    if lines is None:
        return Vec((Vec((found,)),)) if is_matrix(value) else Vec((found,))
    assert isinstance(found, Vec)
    return Vec((found,)) if axis in (0, -2) else Vec(tuple(Vec((item,)) for item in found.items))
