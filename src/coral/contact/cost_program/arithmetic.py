"""Arithmetic of numbers, vectors and lists, with NumPy's rules for arrays of different lengths."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import is_truth, is_whole, no_truth, number, root, scalar
from coral.contact.cost_program.values import NUMBER, Number, Seq, Value, Vec, bounded, kind


def binary(meter: Meter, symbol: str, a: Value, b: Value) -> Value:
    """Apply an arithmetic operator or comparison to numbers, vectors or lists.

    Raises:
        CostError: The operator does not apply to these values.
    """
    if isinstance(a, NUMBER) and isinstance(b, NUMBER):
        return scalar(meter, symbol, a, b)
    if isinstance(a, Seq) and isinstance(b, Seq):
        if symbol == "+" and a.kind == b.kind in ("list", "tuple"):
            return bounded(meter, Seq(a.items + b.items, a.kind))
        raise meter.fault("wrong_type", f"`{symbol}` does not apply to two {a.kind}s; make them arrays with np.array")
    if isinstance(a, Vec) or isinstance(b, Vec):
        return _arrays(meter, symbol, a, b)
    if isinstance(a, Seq) or isinstance(b, Seq):
        raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}; use np.array")
    if symbol in ("==", "!=") and isinstance(a, str) and isinstance(b, str):
        meter.spend()
        return (a == b) == (symbol == "==")
    raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}")


def _arrays(meter: Meter, symbol: str, a: Value, b: Value) -> Value:
    def apply(x: Value, y: Value) -> Value:
        if not (isinstance(x, NUMBER) and isinstance(y, NUMBER)):
            raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}")
        if symbol == "**" and is_whole(x) and is_whole(y) and not (isinstance(y, int) and y >= 0):
            raise meter.fault("wrong_type", "NumPy refuses negative powers of whole numbers; write 2.0, not 2")
        return scalar(meter, symbol, x, y)

    return elementwise(meter, apply, a, b)


def elementwise(meter: Meter, function: Callable[..., Value], *values: Value) -> Value:
    """Apply a function of numbers to vectors and numbers, broadcast as NumPy does.

    Raises:
        CostError: The lengths do not match.
    """
    given = [as_vector(meter, value) for value in values]
    sizes = [len(value.items) for value in given if isinstance(value, Vec)]
    if not sizes:
        return function(*given)
    count = max(sizes)
    if not set(sizes) <= {1, count}:
        text = " and ".join(f"a vector of {size}" for size in sizes)
        raise meter.fault("wrong_size", f"{text} do not match")
    columns = [
        (value.items if len(value.items) == count else value.items * count)
        if isinstance(value, Vec)
        else (value,) * count
        for value in given
    ]
    return Vec(tuple(map(function, *columns)))


def as_vector(meter: Meter, value: Value) -> Value:
    """Convert a list or tuple to the vector that np.array would make; return anything else unchanged.

    The entries become decimals if one of them is, else whole numbers if one of them is.

    Raises:
        CostError: It holds something else than numbers, or nothing.
    """
    if not isinstance(value, Seq):
        return value
    if value.kind == "iterator":
        raise meter.fault("wrong_type", "an iterator is no array; write list(...) around it")
    if not value.items:
        raise meter.fault("wrong_size", "an array has at least one entry")
    for item in value.items:
        if isinstance(item, Vec | Seq):
            raise meter.fault(
                "wrong_size", "an array has one axis; write a list of vectors, and quat_rotate(q, v) for rotations"
            )
        number(meter, item)
    if all(map(is_truth, value.items)):
        return bounded(meter, Vec(value.items))
    whole = all(map(is_whole, value.items))

    def renewed(item: Value) -> Value:
        if isinstance(item, np.ndarray):
            return item.astype(np.int64 if whole else np.float64, copy=False)
        return int(cast(int, item)) if whole else float(cast(float, item))

    return bounded(meter, Vec(tuple(map(renewed, value.items))))


def components(meter: Meter, value: Value, what: str = "a vector") -> tuple[Value, ...]:
    """Return the components of a vector.

    Raises:
        CostError: The value is not a vector of numbers.
    """
    found = as_vector(meter, value)
    if isinstance(found, Vec):
        return found.items
    raise meter.fault("wrong_type", f"{what} is needed here, not {kind(value)}")


def total(meter: Meter, items: tuple[Value, ...]) -> Value:
    """Sum from left to right, as Python and NumPy do for short vectors."""
    found: Value = number(meter, items[0])
    for item in items[1:]:
        found = scalar(meter, "+", found, number(meter, item))
    return found


def dot(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the scalar product.

    Raises:
        CostError: The lengths do not match.
    """
    x, y = components(meter, a), components(meter, b)
    if len(x) != len(y):
        raise meter.fault("wrong_size", f"a vector of {len(x)} and a vector of {len(y)} do not match")
    return total(meter, tuple(scalar(meter, "*", one, other) for one, other in zip(x, y, strict=True)))


def norm(meter: Meter, value: Value) -> Value:
    """Compute the Euclidean length."""
    items = components(meter, value)
    square = total(meter, tuple(scalar(meter, "*", x, x) for x in items))
    length = root(meter, number(meter, square))
    if meter.trace is not None:
        meter.trace.distance(meter.line, length)
    return length


def negative(meter: Meter, value: Value) -> Value:
    """Negate the value."""

    def change(x: Value) -> Number:
        meter.spend()
        if isinstance(x, np.ndarray):
            meter.made()
        found = -no_truth(meter, x)  # type: ignore[misc]
        return meter.as_plain(found) if meter.is_plain(x) else found

    if isinstance(value, Seq):
        raise meter.fault("wrong_type", f"`-` does not apply to {kind(value)}; use np.array")
    return elementwise(meter, change, value)
