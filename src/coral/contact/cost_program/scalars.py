"""Numbers and truth values of a batch: every operation is applied to all states at once, with the kinds of NumPy."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.values import NUMBER, DictValue, Number, Seq, Value, Vec, kind

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
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


def is_truth(value: Value) -> bool:
    """Check whether the value is a truth value, constant or per state."""
    return isinstance(value, bool) or (isinstance(value, np.ndarray) and value.dtype == np.bool_)


def is_whole(value: Value) -> bool:
    """Check whether the value is a whole number, or a truth value, which counts as one."""
    return isinstance(value, int) or (isinstance(value, np.ndarray) and value.dtype != np.float64)


def number(meter: Meter, value: Value) -> Number:
    """Return the value as a number; truth values count as the whole numbers 0 and 1.

    Raises:
        CostError: The value is not a number.
    """
    if isinstance(value, np.ndarray):
        if value.dtype == np.bool_:
            meter.made()
            return value.astype(np.int64)
        return value
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, int | float):
        return value
    raise meter.fault("wrong_type", f"a number is needed here, not {kind(value)}")


def no_truth(meter: Meter, value: Value) -> Number:
    """Return the value, a number.

    Raises:
        CostError: It is a truth value, which NumPy's functions treat unlike 0 and 1, or no number.
    """
    if is_truth(value):
        raise meter.fault("wrong_type", "NumPy treats a truth value unlike a number here; write float(...) around it")
    return number(meter, value)


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
    if value is None or isinstance(value, bool | int | float | str):
        return bool(value)
    if isinstance(value, Seq | DictValue) and getattr(value, "kind", "") != "iterator":
        return bool(value.items)
    use = "; use its norm, np.any or np.all" if isinstance(value, Vec) else ""
    raise meter.fault("wrong_type", f"{kind(value)} is neither true nor false{use}")


def where(meter: Meter, condition: Mask, a: Value, b: Value) -> Number:
    """Return `a` in the states where the condition holds and `b` in the others, each of its own kind of number."""
    found = chosen(meter, condition, a, b)
    return meter.as_plain(found) if meter.is_plain(a) or meter.is_plain(b) else found


def chosen(meter: Meter, condition: Mask, a: Value, b: Value) -> Number:
    """Return the same as `where`, as a number of NumPy."""
    meter.made()
    if is_truth(a) and is_truth(b):
        return np.where(condition, cast(Mask, a), cast(Mask, b))
    sort: Any = np.int64 if is_whole(a) and is_whole(b) else np.float64
    x, y = (np.asarray(number(meter, value), dtype=sort) for value in (a, b))
    return cast(Number, np.where(condition, x, y))


def scalar(meter: Meter, symbol: str, a: Value, b: Value) -> Number:
    """Apply an operator to two numbers.

    Raises:
        CostError: An operand is not a number, or both are constants and the result does not exist.
    """
    if not (isinstance(a, NUMBER) and isinstance(b, NUMBER)):
        a, b = number(meter, a), number(meter, b)
    meter.spend()
    if symbol not in COMPARISONS and symbol != "/" and is_truth(a) and is_truth(b):
        raise meter.fault("wrong_type", f"NumPy's {symbol} of two truth values is no sum of numbers; write float(a)")
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        meter.made()
        plain = meter.is_plain(a) and meter.is_plain(b)
        if symbol in ("/", "//", "%") and (plain or is_whole(b)):
            meter.refuse_where(np.equal(b, 0), "division_by_zero", "the divisor is 0 in some state; guard it with max")
        if symbol not in COMPARISONS and is_whole(a) and is_whole(b):
            return _whole(meter, symbol, a, b)
        found = np.asarray(a, dtype=np.float64) ** b if symbol == "**" else OPERATORS[symbol](a, b)
        if not plain:
            return cast(Number, found)
        if symbol == "**":
            lost = ~np.isfinite(found) & np.isfinite(a) & np.isfinite(b)
            meter.refuse_where(lost, "not_finite", "this power is no decimal in some state; guard it with max")
        return meter.as_plain(cast(Number, found))
    a, b = number(meter, a), number(meter, b)
    if symbol == "**":
        return _constant_power(meter, cast(float, a), cast(float, b))
    if symbol in ("/", "//", "%") and b == 0:
        raise meter.fault("division_by_zero", "the divisor is the constant 0")
    try:
        found = OPERATORS[symbol](a, b)
    except OverflowError:
        raise meter.fault("too_large_number", "the result is too large") from None
    return checked(meter, cast(Number, found))


def _whole(meter: Meter, symbol: str, a: Number, b: Number) -> Number:
    """Apply an operator to whole numbers of which one depends on the state.

    Raises:
        CostError: Python or NumPy gives something else than whole numbers, or none.
    """
    a, b = number(meter, a), number(meter, b)
    if symbol == "**" and not (isinstance(b, int) and b >= 0):
        raise meter.fault("wrong_type", "a power of whole numbers takes a constant exponent; write float(a) ** b")
    rough = OPERATORS[symbol](np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64))
    if symbol == "/":
        return meter.as_plain(cast(Number, rough))
    meter.refuse_where(~(np.abs(rough) <= LARGEST_INT), "too_large_number", "whole numbers reach to 2**53")
    return cast(Number, OPERATORS[symbol](a, b))


def checked(meter: Meter, value: Number) -> Number:
    """Return the constant after a range check.

    Raises:
        CostError: The value is a whole number that arrays could not hold exactly.
    """
    if isinstance(value, int) and abs(value) > LARGEST_INT:
        raise meter.fault("too_large_number", "whole numbers reach to 2**53")
    return value


def _constant_power(meter: Meter, a: float, b: float) -> Number:
    whole = isinstance(a, int) and isinstance(b, int) and b >= 0
    try:
        rough = math.pow(a, b)
        if whole and abs(rough) > LARGEST_INT:
            raise OverflowError
        return cast(Number, a**b) if whole else rough
    except (OverflowError, ValueError):
        raise meter.fault("too_large_number", f"{a} ** {b} is no number that fits") from None


def root(meter: Meter, value: Number) -> Number:
    """Compute the square root."""
    meter.made()
    return pointwise(meter, np.sqrt, value)


def pointwise(meter: Meter, function: Callable[..., Any], *values: Number) -> Number:
    """Apply a NumPy function to numbers; of constants it makes a constant, whole where NumPy's is.

    Raises:
        CostError: It is a whole number that arrays could not hold exactly.
    """
    found = function(*values)
    if any(isinstance(value, np.ndarray) for value in values):
        if found.dtype == np.int64:
            meter.refuse_where(np.abs(found) > LARGEST_INT, "too_large_number", "whole numbers reach to 2**53")
        return cast(Number, found)
    return checked(meter, cast(Number, found.item() if isinstance(found, np.generic | np.ndarray) else found))


def invert(meter: Meter, value: Value) -> bool | Mask:
    """Apply `not` to a truth value."""
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
