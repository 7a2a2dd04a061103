"""Arithmetic, comparison and logic on numbers and vectors, applied to all states of the batch at once."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.sharing import LAZY, memory
from coral.contact.cost_program.texts import joined_text
from coral.contact.cost_program.values import (
    NUMBER,
    ContactList,
    DictValue,
    Number,
    Seq,
    Value,
    Vec,
    bounded,
    is_matrix,
    kind,
)

LARGEST_INT = 2**53  # the largest whole number that stays exact among arrays of float64

OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
UNLIKE_BOOL = ("+", "-", "//", "%", "**")
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


def number(meter: Meter, value: Value) -> Number:
    """Return the value as a number; truth values count as 0 and 1.

    Raises:
        CostError: The value is not a number.
    """
    if isinstance(value, np.ndarray):
        if value.dtype == np.bool_:
            meter.made()
            return value.astype(np.float64)
        return value
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, int | float):
        return value
    if isinstance(value, ContactList):
        raise meter.fault("wrong_type", "a list of contact points is no number; use len(...)")
    if isinstance(value, Vec) and len(value.items) == 1:
        return number(meter, value.items[0])
    raise meter.fault("wrong_type", f"a number is needed here, not {kind(value)}")


def truth(meter: Meter, value: Value) -> bool | Mask:
    """Return whether the value is true, per state.

    Raises:
        CostError: The value is a vector or something else without a truth value.
    """
    if isinstance(value, np.ndarray):
        if value.dtype == np.bool_:
            return value
        meter.made()
        return cast(Mask, value != 0)
    if isinstance(value, ContactList):
        return value.touching
    if value is None or isinstance(value, bool | int | float | str):
        return bool(value)
    if isinstance(value, Seq | DictValue):
        return bool(value.items) or (isinstance(value, Seq) and value.kind in ("iterator", "reversed", "generator"))
    if isinstance(value, Vec):
        if len(value.items) == 1:
            return truth(meter, value.items[0])
        raise meter.fault("wrong_type", f"{kind(value)} is neither true nor false; use its norm, np.any or np.all")
    return True


def where(meter: Meter, condition: Mask, a: Value, b: Value) -> Number:
    """Return `a` in the states where the condition holds and `b` in the others; both are numbers."""
    meter.made()
    if is_truth(a) and is_truth(b):
        return np.where(condition, cast(Mask, a), cast(Mask, b))
    a, b = number(meter, a), number(meter, b)
    return cast(Number, np.where(condition, _as_float(a), _as_float(b)))


def _as_float(value: Number) -> Any:
    return value if isinstance(value, np.ndarray) else float(value)


def is_truth(value: Value) -> bool:
    """Check whether the value is a truth value, constant or per state."""
    return isinstance(value, bool) or (isinstance(value, np.ndarray) and value.dtype == np.bool_)


def scalar(meter: Meter, symbol: str, a: Value, b: Value) -> Number:
    """Apply an operator to two numbers.

    Raises:
        CostError: An operand is not a number, or both are constants and the result does not exist.
    """
    x, y = a, b
    a, b = number(meter, x), number(meter, y)
    if a is not x and b is not y and symbol in UNLIKE_BOOL and _unlike_numbers(x, y):
        raise meter.fault("wrong_type", f"NumPy's {symbol} of two truth values is no sum of numbers; write float(a)")
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        meter.made()
        if symbol == "**":
            return cast(Number, np.asarray(a, dtype=np.float64) ** b)
        return cast(Number, OPERATORS[symbol](a, b))
    if symbol == "**":
        return _constant_power(meter, a, b)
    if symbol in ("/", "//", "%") and b == 0:
        raise meter.fault("division_by_zero", "the divisor is the constant 0")
    try:
        found = OPERATORS[symbol](a, b)
    except OverflowError:
        raise meter.fault("too_large_number", "the result is too large") from None
    return checked(meter, cast(Number, found))


def _unlike_numbers(a: Value, b: Value) -> bool:
    """Check whether both are truth values and at least one depends on the state: NumPy treats those unlike Python."""
    return is_truth(a) and is_truth(b) and not (isinstance(a, bool) and isinstance(b, bool))


def checked(meter: Meter, value: Number) -> Number:
    """Return the constant after a range check.

    Raises:
        CostError: The value is a whole number that arrays could not hold exactly.
    """
    if isinstance(value, int) and abs(value) > LARGEST_INT:
        raise meter.fault("too_large_number", "whole numbers reach to 2**53")
    return value


def _constant_power(meter: Meter, a: float, b: float) -> Number:
    small = isinstance(a, int) and isinstance(b, int) and abs(a) <= 1024 and 0 <= b <= 5
    try:
        found = a**b if small else math.pow(a, b)
    except (OverflowError, ValueError):
        raise meter.fault("too_large_number", f"{a} ** {b} is no number that fits") from None
    return cast(Number, found)


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
        return elementwise(meter, lambda x, y: binary(meter, symbol, x, y), a, b)
    if isinstance(a, Seq) or isinstance(b, Seq):
        raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}; use np.array")
    if symbol == "+" and isinstance(a, str) and isinstance(b, str):
        return joined_text(meter, [a, b])
    if symbol in ("==", "!=") and (a is None or b is None or (isinstance(a, str) and isinstance(b, str))):
        return (a == b) == (symbol == "==")
    if isinstance(a, ContactList) or isinstance(b, ContactList):
        raise meter.fault("wrong_type", "a list of contact points is no number; use len(...)")
    raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}")


def _repeat_sequence(meter: Meter, a: Value, b: Value) -> Value:
    seq, times = (a, b) if isinstance(a, Seq) else (b, a)
    assert isinstance(seq, Seq)
    assert isinstance(times, int)
    if seq.kind not in ("list", "tuple"):
        raise meter.fault("wrong_type", f"{kind(seq)} cannot be repeated; write list(...) around it")
    if times * max(len(seq.items), 1) > meter.cfg.items:
        raise meter.fault("memory", f"a list of more than {meter.cfg.items} entries")
    return bounded(meter, Seq(seq.items * times, seq.kind))


def elementwise(meter: Meter, function: Callable[[Value, Value], Value], a: Value, b: Value) -> Value:
    """Apply a function of two numbers to each pair of components, with NumPy's rules for a vector and a number.

    Raises:
        CostError: The lengths do not match.
    """
    a, b = as_vector(meter, a), as_vector(meter, b)
    if isinstance(a, Vec) and isinstance(b, Vec):
        if is_matrix(a) != is_matrix(b):
            if is_matrix(a):
                return Vec(tuple(elementwise(meter, function, row, b) for row in a.items))
            return Vec(tuple(elementwise(meter, function, a, row) for row in b.items))
        n, m = len(a.items), len(b.items)
        if n != m and 1 not in (n, m):
            raise meter.fault("wrong_size", f"a vector of {n} and a vector of {m} do not match")
        left = a.items * m if n == 1 else a.items
        right = b.items * n if m == 1 else b.items
        return Vec(tuple(elementwise(meter, function, x, y) for x, y in zip(left, right, strict=True)))
    if isinstance(a, Vec):
        return Vec(tuple(elementwise(meter, function, x, b) for x in a.items))
    if isinstance(b, Vec):
        return Vec(tuple(elementwise(meter, function, a, y) for y in b.items))
    return function(a, b)


def each(meter: Meter, function: Callable[[Number], Number], value: Value) -> Value:
    """Apply a function of one number to a number or to every component."""
    value = as_vector(meter, value)
    if isinstance(value, Vec):
        return Vec(tuple(each(meter, function, item) for item in value.items))
    return function(number(meter, value))


def as_vector(meter: Meter, value: Value) -> Value:
    """Convert a list or tuple to the vector that np.array would make; return anything else unchanged.

    Raises:
        CostError: Its rows differ in length.
    """
    if not isinstance(value, Seq):
        return value
    if value.kind in (*LAZY, "set"):
        raise meter.fault("wrong_type", f"{kind(value)} is no array; write list(...) around it")
    items = tuple(as_vector(meter, item) for item in value.items)
    sizes = {len(item.items) if isinstance(item, Vec) else 0 for item in items}
    if len(sizes) > 1:
        raise meter.fault("wrong_size", "the rows of an array must have one length")
    for item in items:
        if not isinstance(item, Vec):
            number(meter, item)
        elif is_matrix(item):
            raise meter.fault("wrong_size", "an array has one or two axes; keep several matrices in a list")
    return bounded(meter, Vec(items))


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
    if not items:
        return 0
    found: Value = items[0]
    for item in items[1:]:
        found = scalar(meter, "+", found, item)
    return number(meter, found)


def dot(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the scalar product, or the matrix product if either operand is a matrix.

    Raises:
        CostError: The lengths do not match.
    """
    a, b = as_vector(meter, a), as_vector(meter, b)
    if isinstance(a, NUMBER) or isinstance(b, NUMBER):
        return binary(meter, "*", a, b)
    if is_matrix(a):
        assert isinstance(a, Vec)
        return Vec(tuple(dot(meter, row, b) for row in a.items))
    left = components(meter, a)
    if is_matrix(b):
        assert isinstance(b, Vec)
        columns = transposed(meter, b)
        return Vec(tuple(dot(meter, Vec(left), column) for column in columns.items))
    right = components(meter, b)
    if len(left) != len(right):
        raise meter.fault("wrong_size", f"a vector of {len(left)} and a vector of {len(right)} do not match")
    return total(meter, tuple(scalar(meter, "*", x, y) for x, y in zip(left, right, strict=True)))


def transposed(meter: Meter, value: Vec) -> Vec:
    """Swap rows and columns; a plain vector is returned unchanged."""
    if not is_matrix(value):
        return value
    rows = [components(meter, row) for row in value.items]
    marks = memory(value)
    return Vec(tuple(Vec(column, "", marks) for column in zip(*rows, strict=True)), "", marks)


def norm(meter: Meter, value: Value) -> Value:
    """Compute the Euclidean length."""
    items = components(meter, value)
    square = total(meter, tuple(scalar(meter, "*", x, x) for x in items))
    length = root(meter, number(meter, square))
    return length if meter.trace is None else meter.trace.distance(meter.line, items, length)


def root(meter: Meter, value: Number) -> Number:
    """Compute the square root."""
    meter.made()
    return unary(np.sqrt, value)


def unary(function: Callable[[Any], Any], value: Number) -> Number:
    """Apply a NumPy function of one number; a constant stays a plain number."""
    if isinstance(value, np.ndarray):
        return cast(Number, function(value))
    found = function(np.float64(value))
    return bool(found) if isinstance(found, np.bool_) else float(found)


def negative(meter: Meter, value: Value) -> Value:
    """Negate the value."""

    def change(x: Number) -> Number:
        if isinstance(x, np.ndarray):
            meter.made()
        return -x  # type: ignore[misc]

    return each(meter, change, value)


def invert(meter: Meter, value: Value) -> Value:
    """Apply `not` to a truth value or to every component."""
    found = truth(meter, value)
    if isinstance(found, np.ndarray):
        meter.made()
        return ~found
    return not found


def both(meter: Meter, a: bool | Mask, b: bool | Mask) -> bool | Mask:
    """Compute the logical and of truth values."""
    meter.made()
    return a and b if isinstance(a, bool) and isinstance(b, bool) else np.logical_and(a, b)


def either(meter: Meter, a: bool | Mask, b: bool | Mask) -> bool | Mask:
    """Compute the logical or of truth values."""
    meter.made()
    return a or b if isinstance(a, bool) and isinstance(b, bool) else np.logical_or(a, b)
