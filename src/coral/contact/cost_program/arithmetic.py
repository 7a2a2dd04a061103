"""Arithmetic of numbers, arrays and lists, with NumPy's rules for arrays of different shapes."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import is_truth, is_whole, no_truth, number, root, scalar
from coral.contact.cost_program.sharing import LAZY, memory
from coral.contact.cost_program.texts import joined_text
from coral.contact.cost_program.values import (
    NUMBER,
    ContactList,
    Number,
    Seq,
    Value,
    Vec,
    bounded,
    depth,
    is_matrix,
    kind,
)

NOTHING = "an array has at least one entry"


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
    if symbol == "*" and (isinstance(a, Seq) or isinstance(b, Seq)) and (isinstance(a, int) or isinstance(b, int)):
        return _repeat_sequence(meter, a, b)
    if isinstance(a, Vec) or isinstance(b, Vec):
        return _arrays(meter, symbol, a, b)
    if isinstance(a, Seq) or isinstance(b, Seq):
        raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}; use np.array")
    if symbol == "+" and isinstance(a, str) and isinstance(b, str):
        return joined_text(meter, [a, b])
    if symbol in ("==", "!=") and (a is None or b is None or (isinstance(a, str) and isinstance(b, str))):
        meter.spend()
        return (a == b) == (symbol == "==")
    if isinstance(a, ContactList) or isinstance(b, ContactList):
        raise meter.fault("wrong_type", "a list of contact points is no number; use len(...)")
    raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}")


def _arrays(meter: Meter, symbol: str, a: Value, b: Value) -> Value:
    def apply(x: Value, y: Value) -> Value:
        if not (isinstance(x, NUMBER) and isinstance(y, NUMBER)):
            raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}")
        if symbol == "**" and is_whole(x) and is_whole(y) and not (isinstance(y, int) and y >= 0):
            raise meter.fault("wrong_type", "NumPy refuses negative powers of whole numbers; write 2.0, not 2")
        return scalar(meter, symbol, x, y)

    return elementwise(meter, apply, a, b)


def _repeat_sequence(meter: Meter, a: Value, b: Value) -> Value:
    seq, times = (a, b) if isinstance(a, Seq) else (b, a)
    assert isinstance(seq, Seq)
    assert isinstance(times, int)
    if seq.kind not in ("list", "tuple"):
        raise meter.fault("wrong_type", f"{kind(seq)} cannot be repeated; write list(...) around it")
    if times * max(len(seq.items), 1) > meter.cfg.items:
        raise meter.fault("memory", f"a list of more than {meter.cfg.items} entries")
    return bounded(meter, Seq(seq.items * times, seq.kind))


def elementwise(meter: Meter, function: Callable[..., Value], *values: Value) -> Value:
    """Apply a function of numbers to arrays and numbers, broadcast as NumPy does.

    Raises:
        CostError: The shapes do not match.
    """
    arrays = [as_vector(meter, value) for value in values]
    depths = [depth(value) for value in arrays]
    deepest = max(depths)
    if not deepest:
        return function(*arrays)
    deep = [value.items for value, n in zip(arrays, depths, strict=True) if n == deepest and isinstance(value, Vec)]
    count = max(map(len, deep))
    if not {len(items) for items in deep} <= {1, count}:
        what = "a vector" if deepest == 1 else "a matrix"
        sizes = " and ".join(f"{what} of {len(items)}" for items in deep)
        raise meter.fault("wrong_size", f"{sizes} do not match")
    columns = [
        (value.items if len(value.items) == count else value.items * count)
        if n == deepest and isinstance(value, Vec)
        else (value,) * count
        for value, n in zip(arrays, depths, strict=True)
    ]
    if deepest == 1:
        return Vec(tuple(map(function, *columns)))
    return Vec(tuple(elementwise(meter, function, *row) for row in zip(*columns, strict=True)))


def as_vector(meter: Meter, value: Value) -> Value:
    """Convert a list or tuple to the vector that np.array would make; return anything else unchanged.

    Raises:
        CostError: Its rows differ in length, or it has no entries.
    """
    if not isinstance(value, Seq):
        return value
    if value.kind in LAZY:
        raise meter.fault("wrong_type", f"{kind(value)} is no array; write list(...) around it")
    items = tuple(as_vector(meter, item) for item in value.items)
    sizes = {len(item.items) if isinstance(item, Vec) else 0 for item in items}
    if len(sizes) != 1:
        raise meter.fault("wrong_size", "the rows of an array must have one length" if items else NOTHING)
    for item in items:
        if not isinstance(item, Vec):
            number(meter, item)
        elif is_matrix(item):
            raise meter.fault("wrong_size", "an array has one or two axes; keep several matrices in a list")
    return bounded(meter, of_one_kind(Vec(items)))


def of_one_kind(value: Vec) -> Vec:
    """Make a new array whose entries are all decimals if one of them is, else all whole if one of them is."""
    leaves = [x for item in value.items for x in (item.items if isinstance(item, Vec) else (item,))]
    if all(map(is_truth, leaves)):
        return value
    whole = all(map(is_whole, leaves))

    def renew(item: Value) -> Value:
        if isinstance(item, Vec):
            return Vec(tuple(map(renew, item.items)), item.order)
        if isinstance(item, np.ndarray):
            return item.astype(np.int64 if whole else np.float64, copy=False)
        return int(cast(int, item)) if whole else float(cast(float, item))

    return Vec(tuple(map(renew, value.items)), value.order)


def components(meter: Meter, value: Value, what: str = "a vector") -> tuple[Value, ...]:
    """Return the components of a vector.

    Raises:
        CostError: The value is not a vector of numbers.
    """
    found = as_vector(meter, value)
    if isinstance(found, Vec) and not is_matrix(found):
        return found.items
    raise meter.fault("wrong_type", f"{what} is needed here, not {kind(value)}")


def total(meter: Meter, items: tuple[Value, ...]) -> Value:
    """Sum from left to right, as Python and NumPy do for short vectors."""
    found: Value = number(meter, items[0])
    for item in items[1:]:
        found = scalar(meter, "+", found, number(meter, item))
    return found


def dot(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the scalar product, or the matrix product if either operand is a matrix.

    Raises:
        CostError: The lengths do not match.
    """
    a, b = as_vector(meter, a), as_vector(meter, b)
    if not (isinstance(a, Vec) and isinstance(b, Vec)):
        raise meter.fault("wrong_type", f"a vector or matrix is needed here, not {kind(b)}")
    if is_matrix(a):
        return Vec(tuple(dot(meter, row, b) for row in a.items))
    if is_matrix(b):
        return Vec(tuple(dot(meter, a, column) for column in transposed(meter, b).items))
    if len(a.items) != len(b.items):
        raise meter.fault("wrong_size", f"a vector of {len(a.items)} and a vector of {len(b.items)} do not match")
    return total(meter, tuple(scalar(meter, "*", x, y) for x, y in zip(a.items, b.items, strict=True)))


def matmul(meter: Meter, a: Value, b: Value, /) -> Value:
    """Evaluate `a @ b`.

    Raises:
        CostError: An operand is a number, or neither is an array.
    """
    x, y = as_vector(meter, a), as_vector(meter, b)
    if not (isinstance(x, Vec) and isinstance(y, Vec) and (isinstance(a, Vec) or isinstance(b, Vec))):
        raise meter.fault("wrong_type", f"`@` does not apply to {kind(a)} and {kind(b)}; use * or np.dot")
    return dot(meter, x, y)


def transposed(meter: Meter, value: Vec) -> Vec:
    """Swap rows and columns; a plain vector is returned unchanged."""
    if not is_matrix(value):
        return value
    rows = [components(meter, row) for row in value.items]
    meter.spend(len(rows) * len(rows[0]))
    marks = memory(value)
    return Vec(tuple(Vec(column, "", marks) for column in zip(*rows, strict=True)), "", marks)


def norm(meter: Meter, value: Value) -> Value:
    """Compute the Euclidean length."""
    items = components(meter, value)
    square = total(meter, tuple(scalar(meter, "*", x, x) for x in items))
    length = root(meter, number(meter, square))
    return length if meter.trace is None else meter.trace.distance(meter.line, items, length)


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
