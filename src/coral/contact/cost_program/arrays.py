"""Making arrays, and converting between decimals and whole numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.arithmetic import as_vector, components, elementwise
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import LARGEST_INT, is_whole, number
from coral.contact.cost_program.values import Builtin, Number, Seq, Value, Vec, kind


def array(meter: Meter, value: Value, dtype: Value = None) -> Value:
    """Make a vector of a list, or return the array itself; `dtype=float` makes decimals.

    Raises:
        CostError: It holds no numbers, or another dtype is asked for.
    """
    found = as_vector(meter, value)
    if dtype is None:
        return found
    if not (isinstance(dtype, Builtin) and dtype.name == "float"):
        raise meter.fault("wrong_call", "arrays hold float64 only; leave dtype out or write dtype=float")
    return elementwise(meter, lambda x: to_float(meter, x), found)


def copied(meter: Meter, a: Value) -> Value:
    """Return the array: it cannot be changed."""
    return a


def to_float(meter: Meter, value: Value = 0.0, /) -> Value:
    """Make a decimal: a number stays one, a truth value becomes 0 or 1, "inf" becomes infinity."""
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


def filled_with(fill: float) -> Callable[..., Value]:
    """Make np.zeros or np.ones."""

    def call(meter: Meter, shape: Value) -> Value:
        if isinstance(shape, int) and not isinstance(shape, bool) and 0 < shape <= meter.cfg.items:
            return Vec((fill,) * shape)
        raise meter.fault("not_fixed", f"a size is a whole number from 1 to {meter.cfg.items}; an array has one axis")

    return call


def concatenated(meter: Meter, arrays: Value) -> Value:
    """Put vectors one after another."""
    if not isinstance(arrays, Seq) or not arrays.items:
        raise meter.fault("wrong_call", f"this takes a list of arrays, not {kind(arrays)}")
    return as_vector(meter, Seq(tuple(x for part in arrays.items for x in components(meter, part))))


def appended(meter: Meter, a: Value, values: Value) -> Value:
    """Put a number or a vector at the end of a vector."""
    more = as_vector(meter, values)
    return concatenated(meter, Seq((a, more if isinstance(more, Vec) else Seq((more,)))))
