"""Making and rearranging arrays: NumPy itself moves the entries, by their numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost_program.arithmetic import NOTHING, as_vector, elementwise, of_one_kind, transposed
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import LARGEST_INT, is_whole, no_truth, number
from coral.contact.cost_program.sharing import renewed, view
from coral.contact.cost_program.values import Builtin, DictValue, Number, Seq, Value, Vec, kind

Places = NDArray[np.intp]
FLOATS = ("float", "np.float64", "float64")


def flat(value: Value) -> tuple[Value, ...]:
    """Return all numbers of an array, row by row, or the number."""
    return tuple(x for item in value.items for x in flat(item)) if isinstance(value, Vec) else (value,)


def shape(value: Value) -> tuple[int, ...]:
    """Return the shape that NumPy would report for one state."""
    if not isinstance(value, Vec):
        return ()
    first = value.items[0]
    return (len(value.items), len(first.items)) if isinstance(first, Vec) else (len(value.items),)


def places(value: Value, start: int = 0) -> Places:
    """Number the entries of an array, or a number, in NumPy's shape."""
    size = shape(value)
    return np.arange(start, start + math.prod(size)).reshape(size)


def arranged(meter: Meter, function: Callable[..., Places], *values: Value) -> Vec:
    """Let NumPy rearrange the entries of arrays.

    Args:
        meter: The evaluation.
        function: Takes the numbered entries of each array, and returns their new places.
        values: The arrays.

    Raises:
        CostError: NumPy refuses, or the result is empty or has more than two axes.
    """
    items: tuple[Value, ...] = ()
    given = []
    for value in values:
        given.append(places(value, len(items)))
        items += flat(value)
    try:
        found = function(*given)
    except (ValueError, TypeError, IndexError) as error:
        raise meter.fault("wrong_size", f"NumPy refuses this: {error}") from None
    meter.spend(found.size)
    if not found.size or found.ndim not in (1, 2):
        raise meter.fault("wrong_size", "an array has one or two axes" if found.size else NOTHING)
    if found.size > meter.cfg.items:
        raise meter.fault("memory", f"an array has at most {meter.cfg.items} entries")
    if found.ndim == 1:
        return Vec(tuple(items[k] for k in found))
    return Vec(tuple(Vec(tuple(items[k] for k in row)) for row in found))


def floats(meter: Meter, dtype: Value) -> bool:
    """Return whether a dtype asks for decimals; None asks for nothing.

    Raises:
        CostError: It is another one.
    """
    name = dtype.name if isinstance(dtype, Builtin) else dtype
    if name is not None and (not isinstance(name, str) or name not in FLOATS):
        raise meter.fault("wrong_call", "arrays hold float64 only; leave dtype out or write dtype=float")
    return name is not None


def array(meter: Meter, value: Value, dtype: Value = None) -> Value:
    """Make a new vector or matrix."""
    found = as_vector(meter, value)
    if floats(meter, dtype):
        found = elementwise(meter, lambda x: to_float(meter, x), found)
    return renewed(found)


def asarray(meter: Meter, value: Value, dtype: Value = None) -> Value:
    """Return the array itself, or a new one made from a list or with another dtype."""
    if floats(meter, dtype) and is_whole(flat(value)[0]):
        return array(meter, value, dtype)
    return value


def as_type(meter: Meter, value: Value, dtype: Value) -> Value:
    """Evaluate `astype(float)`."""
    if not floats(meter, dtype):
        raise meter.fault("wrong_call", "arrays hold float64 only; write astype(float)")
    return array(meter, value, dtype)


def to_float(meter: Meter, value: Value = 0.0, /) -> Value:
    """Evaluate `float(...)`: a number stays one, a truth value becomes 0 or 1, "inf" becomes infinity."""
    if isinstance(value, str):
        if value in ("inf", "-inf"):
            return float(value)
        raise meter.fault("wrong_type", "float takes a number")
    found = number(meter, value)
    return found.astype(np.float64, copy=False) if isinstance(found, np.ndarray) else float(found)


def to_plain(meter: Meter, value: Value = 0.0, /) -> Value:
    """Evaluate Python's `float`."""
    found = to_float(meter, value)
    return meter.as_plain(found.view()) if isinstance(found, np.ndarray) else found


def to_int(meter: Meter, value: Value = 0, /) -> Value:
    """Evaluate `int(...)`: drop the fractional part."""
    return whole(meter, np.trunc, number(meter, value))


def whole(meter: Meter, function: Callable[..., Any], value: Number) -> Number:
    """Make a whole number of a number, by rounding it in some way.

    Raises:
        CostError: It is not finite, or too large, in some state that counts.
    """
    if is_whole(value):
        return value
    meter.made()
    found = np.asarray(function(value), dtype=np.float64)
    lost = ~(np.abs(found) <= LARGEST_INT)
    meter.refuse_where(lost, "too_large_number", "no whole number can be made of this; guard it with max and min")
    found = np.where(lost, 0.0, found).astype(np.int64)
    return cast(Number, found if isinstance(value, np.ndarray) else int(found))


def _size(meter: Meter, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool) and 0 < value <= meter.cfg.items:
        return value
    raise meter.fault("not_fixed", f"a size is a whole number from 1 to {meter.cfg.items}")


def filled_with(fill: float) -> Callable[..., Value]:
    """Make np.zeros or np.ones."""

    def call(meter: Meter, shape: Value, dtype: Value = None) -> Value:
        floats(meter, dtype)
        sizes = [_size(meter, item) for item in (shape.items if isinstance(shape, Seq) else (shape,))]
        if not 1 <= len(sizes) <= 2 or math.prod(sizes) > meter.cfg.items:
            raise meter.fault("wrong_size", f"an array has one or two axes and at most {meter.cfg.items} entries")
        row = (fill,) * sizes[-1]
        return Vec(row) if len(sizes) == 1 else Vec(tuple(Vec(row) for _ in range(sizes[0])))

    return call


def like(fill: int) -> Callable[..., Value]:
    """Make np.zeros_like or np.ones_like."""

    def call(meter: Meter, a: Value, dtype: Value = None) -> Value:
        decimals = floats(meter, dtype)
        return elementwise(meter, lambda x: fill if is_whole(no_truth(meter, x)) and not decimals else float(fill), a)

    return call


def eye(meter: Meter, N: Value) -> Value:
    """Make the identity matrix."""
    size = _size(meter, N)
    if size > 16:
        raise meter.fault("wrong_size", "eye takes at most 16")
    return Vec(tuple(Vec(tuple(float(i == j) for j in range(size))) for i in range(size)))


def joined(function: Callable[..., Any]) -> Callable[..., Value]:
    """Make np.concatenate or np.stack."""

    def call(meter: Meter, arrays: Value, axis: Value = 0) -> Value:
        return _joined(meter, function, arrays, axis=axis)

    return call


def stacked(function: Callable[..., Any]) -> Callable[..., Value]:
    """Make np.hstack or np.vstack."""

    def call(meter: Meter, tup: Value) -> Value:
        return _joined(meter, function, tup)

    return call


def _joined(meter: Meter, function: Callable[..., Any], arrays: Value, **options: Value) -> Value:
    if not isinstance(arrays, Vec) and not (isinstance(arrays, Seq) and arrays.kind in ("list", "tuple")):
        raise meter.fault("wrong_call", f"this takes a list of arrays, not {kind(arrays)}")
    if not all(isinstance(value, int) and not isinstance(value, bool) for value in options.values()):
        raise meter.fault("wrong_call", "axis is a constant whole number")
    parts = [as_vector(meter, part) for part in arrays.items]
    for part in parts:
        if not isinstance(part, Vec):
            number(meter, part)

    def join(*given: Places) -> Places:
        return cast(Places, function(given, **options))

    return renewed(of_one_kind(arranged(meter, join, *parts)))


def reshape(meter: Meter, a: Value, shape: Value) -> Value:
    """Evaluate np.reshape: the same numbers as a vector or as the rows of a matrix."""
    sizes = shape.items if isinstance(shape, Seq) else (shape,)
    if not all(isinstance(n, int) and not isinstance(n, bool) for n in sizes):
        raise meter.fault("not_fixed", "a shape holds constant whole numbers")
    found = arranged(meter, lambda x: x.reshape(sizes), a)
    return view(tuple(view(row.items, a) if isinstance(row, Vec) else row for row in found.items), a)


def reshaped(meter: Meter, value: Value, /, *shape: Value) -> Value:
    """Evaluate the method reshape."""
    return reshape(meter, value, shape[0] if len(shape) == 1 else Seq(shape, "tuple"))


def ravel(meter: Meter, a: Value) -> Value:
    """Return all numbers as one vector that shares memory with the array."""
    return reshape(meter, a, -1)


def flatten(meter: Meter, value: Value) -> Value:
    """Return all numbers as a vector with its own memory."""
    return renewed(Vec(flat(value)))


def to_list(meter: Meter, value: Value) -> Value:
    """Evaluate `tolist()`: a list of numbers, or for a matrix a list of lists."""
    if isinstance(value, Vec):
        return Seq(tuple(to_list(meter, item) for item in value.items))
    return meter.as_plain(value.view()) if isinstance(value, np.ndarray) else value


def item(meter: Meter, value: Value) -> Value:
    """Evaluate `item()`: the number of an array that holds one."""
    only, *more = flat(value)
    if more:
        raise meter.fault("wrong_size", f"item() is of an array of one number, not of {kind(value)}")
    return to_list(meter, only)


def transpose(meter: Meter, a: Value) -> Value:
    """Swap rows and columns."""
    assert isinstance(a, Vec)
    return transposed(meter, a)


def copied(meter: Meter, a: Value) -> Value:
    """Return a copy that can be changed without changing the original."""
    return DictValue(dict(a.items)) if isinstance(a, DictValue) else renewed(a)
