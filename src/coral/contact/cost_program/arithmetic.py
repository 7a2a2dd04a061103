"""Arithmetic of numbers and vectors for all states at once, with NumPy's rules for arrays of different lengths."""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.values import Array, Number, Value, bounded, is_vector, kind

LARGEST_INT = 2**53  # the largest whole number that stays exact among arrays of float64

OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
NUMERIC = (np.ndarray, int, float)
"""Types of numbers and vectors."""
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


def is_truth(value: Value) -> bool:
    """Check whether the value is a truth value, constant or per state, or a vector of them."""
    return value.dtype.kind == "b" if isinstance(value, np.ndarray) else isinstance(value, bool)


def numeric(meter: Meter, value: Value) -> Number:
    """Return a number or vector; truth values count as 0 and 1."""
    if isinstance(value, np.ndarray):
        return value.astype(np.float64) if value.dtype.kind == "b" else value
    if isinstance(value, int | float):
        return int(value) if isinstance(value, bool) else value
    raise meter.fault("wrong_type", f"a number is needed here, not {kind(value)}")


def no_truth(meter: Meter, value: Value) -> Number:
    """Return a number or vector."""
    if is_truth(value):
        raise meter.fault("wrong_type", "NumPy treats a truth value unlike a number here; write float(...) around it")
    return numeric(meter, value)


def truth(meter: Meter, value: Value) -> bool | Mask:
    """Return whether the value is true, per state."""
    if isinstance(value, np.ndarray) and value.ndim == 2:
        return value if is_truth(value) else np.not_equal(value, 0)
    if value is None or isinstance(value, int | float | str | list | tuple | dict):
        return bool(value)
    use = "; use its norm, np.any or np.all" if is_vector(value) else ""
    raise meter.fault("wrong_type", f"{kind(value)} is neither true nor false{use}")


def both(meter: Meter, a: bool | Mask, b: bool | Mask) -> bool | Mask:
    """Compute the logical and of truth values."""
    meter.made()
    return a and b if isinstance(a, bool) and isinstance(b, bool) else np.logical_and(a, b)


def where(meter: Meter, condition: Mask, a: Value, b: Value) -> Array:
    """Return `a` in the states where the condition holds and `b` in the others."""
    prepare(meter, condition, a, b)
    sort: Any = np.bool_ if is_truth(a) and is_truth(b) else np.float64
    return np.where(condition, np.asarray(a, dtype=sort), np.asarray(b, dtype=sort))


def prepare(meter: Meter, *values: Value) -> None:
    """Count the result of an operation on numbers and vectors before it is made."""
    count, of_states = 1, False
    for value in values:
        if isinstance(value, np.ndarray) and value.ndim:
            size = len(value) if value.ndim == 3 else 1
            if size != count and 1 not in (size, count):
                raise meter.fault("wrong_size", f"a vector of {count} and a vector of {size} do not match")
            count, of_states = max(size, count), of_states or value.shape[-2:] != (1, 1)
    meter.spend(count)
    if of_states:
        meter.made(count)


def apply(meter: Meter, function: Callable[..., Any], *values: Value) -> Number:
    """Apply a NumPy function to numbers and vectors; of constants it makes a constant."""
    given = [np.asarray(no_truth(meter, as_vector(meter, value)), dtype=np.float64) for value in values]
    prepare(meter, *given)
    found: Array = function(*given)
    return found if found.ndim else found.item()


def binary(meter: Meter, symbol: str, a: Value, b: Value) -> Value:
    """Apply an arithmetic operator or comparison to numbers, vectors or lists."""
    if not (isinstance(a, NUMERIC) and isinstance(b, NUMERIC)):
        if isinstance(a, str) and isinstance(b, str) and symbol in ("==", "!="):
            return (a == b) == (symbol == "==")
        if isinstance(a, list | tuple) and isinstance(b, list | tuple) and symbol == "+" and type(a) is type(b):
            return bounded(meter, [*a, *b] if isinstance(a, list) else (*a, *b))
        x, y = (as_vector(meter, a), as_vector(meter, b)) if is_vector(a) or is_vector(b) else (a, b)
        if not (isinstance(x, NUMERIC) and isinstance(y, NUMERIC)):
            make = "; use np.array" if isinstance(a, list | tuple) or isinstance(b, list | tuple) else ""
            raise meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(a)} and {kind(b)}{make}")
        a, b = x, y
    if is_truth(a) and is_truth(b) and symbol not in (*COMPARISONS, "/"):
        raise meter.fault("wrong_type", f"NumPy's {symbol} of two truth values is no sum of numbers; write float(a)")
    prepare(meter, a, b)
    a, b = numeric(meter, a), numeric(meter, b)
    if not isinstance(a, np.ndarray) and not isinstance(b, np.ndarray):
        return _of_constants(meter, symbol, a, b)
    return OPERATORS[symbol](np.asarray(a, dtype=np.float64) if symbol == "**" else a, b)


def _of_constants(meter: Meter, symbol: str, a: float, b: float) -> Number:
    if symbol in ("/", "//", "%") and b == 0:
        raise meter.fault("division_by_zero", "the divisor is the constant 0")
    try:
        if symbol == "**":
            whole = isinstance(a, int) and isinstance(b, int) and b >= 0
            found = math.pow(a, b)  # before a ** b, which could be huge
            found = a**b if whole and abs(found) <= LARGEST_INT else found
            if whole and not isinstance(found, int):
                raise OverflowError
        else:
            found = OPERATORS[symbol](a, b)
    except (OverflowError, ValueError):
        raise meter.fault("too_large_number", f"{a} {symbol} {b} is no number that fits") from None
    if isinstance(found, int) and abs(found) > LARGEST_INT:
        raise meter.fault("too_large_number", "whole numbers reach to 2**53")
    return found


def as_vector(meter: Meter, value: Value) -> Value:
    """Convert a list or tuple to the vector that np.array would make; return anything else unchanged."""
    if not isinstance(value, list | tuple):
        return value
    if not value:
        raise meter.fault("wrong_size", "an array has at least one entry")
    for item in value:
        if isinstance(item, list | tuple) or is_vector(item):
            raise meter.fault(
                "wrong_size", "an array has one axis; write a list of vectors, and quat_rotate(q, v) for rotations"
            )
    sort: Any = np.bool_ if all(map(is_truth, value)) else np.float64
    return stack(meter, [np.atleast_2d(np.asarray(numeric(meter, item), dtype=sort)) for item in value])


def stack(meter: Meter, items: list[Array]) -> Array:
    """Make a vector of its entries, each of every state or a constant, Shape=(K, H) or (1, 1)."""
    meter.spend(len(items))
    if any(item.shape != (1, 1) for item in items):
        meter.made(len(items))
    found: Array = np.stack(np.broadcast_arrays(*items))
    return found


def components(meter: Meter, value: Value, what: str = "a vector") -> Array:
    """Return a vector, or the one that a list makes, with truth values as 0 and 1."""
    found = as_vector(meter, value)
    if is_vector(found):
        return np.asarray(numeric(meter, found))
    raise meter.fault("wrong_type", f"{what} is needed here, not {kind(value)}")


def total(meter: Meter, vector: Array) -> Array:
    """Sum a vector from left to right, as Python and NumPy do for short ones."""
    prepare(meter, vector)
    return functools.reduce(np.add, vector)


def dot(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the scalar product."""
    x, y = components(meter, a), components(meter, b)
    if len(x) != len(y):
        raise meter.fault("wrong_size", f"a vector of {len(x)} and a vector of {len(y)} do not match")
    return total(meter, np.asarray(binary(meter, "*", as_vector(meter, a), as_vector(meter, b))))


def norm(meter: Meter, value: Value) -> Array:
    """Compute the Euclidean length."""
    vector = components(meter, value)
    prepare(meter, vector)
    return np.asarray(np.sqrt(total(meter, vector * vector)))
