"""Functions of numbers and vectors that a cost may call: a part of `math` and `numpy`, and a few of our own."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.arithmetic import (
    as_vector,
    binary,
    both,
    components,
    each,
    either,
    elementwise,
    invert,
    norm,
    number,
    scalar,
    total,
    truth,
    unary,
    where,
)
from coral.contact.cost_program.iterating import ONCE, entries
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.sharing import renewed
from coral.contact.cost_program.values import (
    NUMBER,
    ContactList,
    DictValue,
    Number,
    Partial,
    Seq,
    Value,
    Vec,
    is_matrix,
    is_one_of,
    kind,
)

Call = Callable[..., Value]
"""Takes the meter, then the arguments of the program."""

UNARY: dict[str, Callable[[Any], Any]] = {
    "sqrt": np.sqrt,
    "exp": np.exp,
    "expm1": np.expm1,
    "log": np.log,
    "log1p": np.log1p,
    "log10": np.log10,
    "log2": np.log2,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "arcsin": np.arcsin,
    "arccos": np.arccos,
    "arctan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "abs": np.abs,
    "square": np.square,
    "sign": np.sign,
    "floor": np.floor,
    "ceil": np.ceil,
    "trunc": np.trunc,
    "rint": np.rint,
    "deg2rad": np.deg2rad,
    "rad2deg": np.rad2deg,
    "isfinite": np.isfinite,
    "isnan": np.isnan,
    "isinf": np.isinf,
    "nan_to_num": np.nan_to_num,
}
BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "maximum": np.maximum,
    "minimum": np.minimum,
    "arctan2": np.arctan2,
    "hypot": np.hypot,
    "fmod": np.fmod,
    "copysign": np.copysign,
    "heaviside": np.heaviside,
    "logaddexp": np.logaddexp,
}


def of_one(name: str) -> Call:
    """Make a builtin that applies a NumPy function of one number to every component."""
    function = UNARY[name]

    def call(meter: Meter, value: Value) -> Value:
        def apply(item: Number) -> Number:
            meter.made()
            return unary(function, item)

        return each(meter, apply, value)

    return call


def of_two(name: str) -> Call:
    """Make a builtin that applies a NumPy function of two numbers to every pair of components."""
    function = BINARY[name]

    def call(meter: Meter, a: Value, b: Value) -> Value:
        def apply(x: Value, y: Value) -> Value:
            meter.made()
            x, y = number(meter, x), number(meter, y)
            found = function(x, y) if isinstance(x, np.ndarray) or isinstance(y, np.ndarray) else float(function(x, y))
            return cast(Number, found)

        return elementwise(meter, apply, a, b)

    return call


def power(meter: Meter, a: Value, b: Value) -> Value:
    """Compute `a ** b`."""
    return binary(meter, "**", a, b)


def operator_call(symbol: str) -> Call:
    """Make the function form of an operator, such as np.add."""

    def call(meter: Meter, a: Value, b: Value) -> Value:
        return binary(meter, symbol, as_vector(meter, a), as_vector(meter, b))

    return call


def clip(meter: Meter, value: Value, a_min: Value = None, a_max: Value = None) -> Value:
    """Clip the value to two bounds, either of which may be None."""
    if a_min is not None:
        value = of_two("maximum")(meter, value, a_min)
    if a_max is not None:
        value = of_two("minimum")(meter, value, a_max)
    return value


def clip01(meter: Meter, value: Value) -> Value:
    """Clip the value to [0, 1]."""
    return clip(meter, value, 0.0, 1.0)


def sigmoid(meter: Meter, value: Value) -> Value:
    """Compute 1 / (1 + exp(-x)) without overflow."""
    half = binary(meter, "*", 0.5, of_one("tanh")(meter, binary(meter, "*", 0.5, value)))
    return binary(meter, "+", 0.5, half)


def near(meter: Meter, distance: Value, scale: Value) -> Value:
    """Compute exp(-(distance / scale)^2): 1 at 0, almost 0 beyond twice the scale."""
    ratio = binary(meter, "/", distance, scale)
    return of_one("exp")(meter, binary(meter, "*", -1.0, binary(meter, "*", ratio, ratio)))


def select(meter: Meter, condition: Value, a: Value, b: Value) -> Value:
    """Evaluate np.where with three arguments."""
    condition = as_vector(meter, condition)
    if isinstance(condition, Vec):
        if not isinstance(as_vector(meter, a), Vec) and not isinstance(as_vector(meter, b), Vec):
            return Vec(tuple(select(meter, item, a, b) for item in condition.items))
        n = len(condition.items)
        left, right = _broadcast_items(meter, a, n), _broadcast_items(meter, b, n)
        return Vec(tuple(select(meter, c, x, y) for c, x, y in zip(condition.items, left, right, strict=True)))
    met = truth(meter, condition)

    def choose(x: Value, y: Value) -> Value:
        if isinstance(met, np.ndarray):
            return where(meter, met, x, y)
        return x if met else y

    return elementwise(meter, choose, a, b)


def _broadcast_items(meter: Meter, value: Value, n: int) -> tuple[Value, ...]:
    value = as_vector(meter, value)
    if not isinstance(value, Vec):
        return (value,) * n
    if len(value.items) != n:
        raise meter.fault("wrong_size", f"a vector of {len(value.items)} and a vector of {n} do not match")
    return value.items


def largest(meter: Meter, items: tuple[Value, ...], symbol: str) -> Value:
    """Evaluate Python's max (symbol ">") or min ("<"): the first of several equal ones."""
    found = items[0]
    for item in items[1:]:
        better = scalar(meter, symbol, item, found)
        if isinstance(better, np.ndarray):
            found = where(meter, cast(Mask, better), item, found)
        else:
            found = item if better else found
    return found


def linalg_norm(meter: Meter, x: Value, ord: Value = None, axis: Value = None, keepdims: Value = False) -> Value:
    """Evaluate np.linalg.norm on a vector, a whole matrix (Frobenius), or its rows (axis 1) or columns (axis 0)."""
    return with_kept_axes(meter, as_vector(meter, x), axis, keepdims, _norms(meter, x, ord, axis))


def _norms(meter: Meter, x: Value, ord: Value, axis: Value) -> Value:
    if not is_one_of(ord, (None, 1, 2, math.inf)):
        raise meter.fault("wrong_call", "norm takes ord 1, 2 or np.inf")
    vector = as_vector(meter, x)
    if isinstance(vector, NUMBER):
        return of_one("abs")(meter, vector)
    if is_matrix(vector):
        assert isinstance(vector, Vec)
        lines = along(meter, vector, axis)
        if lines is not None:
            return Vec(tuple(_norms(meter, line, ord, None) for line in lines))
        vector = Vec(tuple(item for row in vector.items for item in components(meter, row)))
    along(meter, vector, axis)
    if ord is None or ord == 2:
        return norm(meter, vector)
    sizes = components(meter, of_one("abs")(meter, vector))
    if ord == 1:
        return total(meter, sizes)
    return largest(meter, sizes, ">")


def along(meter: Meter, value: Value, axis: Value) -> tuple[Value, ...] | None:
    """Return the lines of a matrix that a reduction over `axis` runs along; None means all components together.

    Raises:
        CostError: The value has no such axis.
    """
    if axis is None:
        return None
    depth = (2 if is_matrix(value) else 1) if isinstance(value, Vec) else 0
    if not isinstance(axis, int) or not -depth <= axis < depth:
        raise meter.fault("wrong_size", f"{kind(value)} has no axis {axis}")
    if depth == 1 or not isinstance(value, Vec):
        return None
    if axis in (1, -1):
        return value.items
    return tuple(Vec(column) for column in zip(*(components(meter, row) for row in value.items), strict=True))


def flat(meter: Meter, value: Value) -> tuple[Value, ...]:
    """Return all numbers of a vector, matrix, list or number.

    Raises:
        CostError: It contains something else.
    """
    value = as_vector(meter, value)
    if isinstance(value, Vec):
        return tuple(number_ for item in value.items for number_ in flat(meter, item))
    if isinstance(value, np.ndarray | bool):
        return (value,)
    return (number(meter, value),)


def with_kept_axes(meter: Meter, value: Value, axis: Value, keepdims: Value, found: Value) -> Value:
    """Return the result of a reduction with axes of length 1 where keepdims asks for them."""
    if not isinstance(keepdims, bool):
        raise meter.fault("wrong_call", "keepdims is True or False")
    if not keepdims or not isinstance(value, Vec):
        return found
    if not is_matrix(value):
        return Vec((found,))
    if axis is None:
        return Vec((Vec((found,)),))
    assert isinstance(found, Vec)
    return Vec((found,)) if axis in (0, -2) else Vec(tuple(Vec((item,)) for item in found.items))


def reduction(name: str) -> Call:
    """Make np.sum, np.mean, np.max, np.min, np.prod, np.any or np.all."""

    def reduce(meter: Meter, items: tuple[Value, ...]) -> Value:
        if not items and name in ("max", "min", "mean"):
            raise meter.fault("wrong_size", f"{name} of nothing")
        if name in ("any", "all"):
            return fold_truth(meter, items, name)
        if name == "prod":
            found: Value = 1.0
            for item in items:
                found = scalar(meter, "*", found, item)
            return found
        if name in ("max", "min"):
            found = items[0]
            for item in items[1:]:
                found = of_two("maximum" if name == "max" else "minimum")(meter, found, item)
            return number(meter, found)
        summed = total(meter, items)
        return summed if name == "sum" else scalar(meter, "/", summed, len(items))

    def call(meter: Meter, a: Value, axis: Value = None, keepdims: Value = False) -> Value:
        value = as_vector(meter, a)
        lines = along(meter, value, axis)
        if lines is None:
            found = reduce(meter, flat(meter, value))
        else:
            found = Vec(tuple(reduce(meter, flat(meter, line)) for line in lines))
        return with_kept_axes(meter, value, axis, keepdims, found)

    return call


def fold_truth(meter: Meter, items: tuple[Value, ...], name: str) -> Value:
    """Reduce truth values by any or all."""
    found: bool | Mask = name == "all"
    for item in items:
        found = (both if name == "all" else either)(meter, found, truth(meter, item))
    return found


def cross(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the cross product of two vectors of length 3."""
    left, right = components(meter, a), components(meter, b)
    if len(left) != 3 or len(right) != 3:
        raise meter.fault("wrong_size", f"cross takes two vectors of 3, not of {len(left)} and {len(right)}")

    def minor(i: int, j: int) -> Value:
        return scalar(meter, "-", scalar(meter, "*", left[i], right[j]), scalar(meter, "*", left[j], right[i]))

    return Vec((minor(1, 2), minor(2, 0), minor(0, 1)))


def outer(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the outer product of two vectors."""
    return Vec(tuple(binary(meter, "*", item, Vec(components(meter, b))) for item in components(meter, a)))


def dist(meter: Meter, a: Value, b: Value) -> Value:
    """Compute the distance between two points, m."""
    return norm(meter, binary(meter, "-", as_vector(meter, a), as_vector(meter, b)))


def isclose(meter: Meter, a: Value, b: Value, atol: Value = 1e-8, rtol: Value = 1e-5) -> Value:
    """Check whether |a - b| <= atol + rtol |b|."""
    gap = of_one("abs")(meter, binary(meter, "-", a, b))
    return binary(meter, "<=", gap, binary(meter, "+", atol, binary(meter, "*", rtol, of_one("abs")(meter, b))))


def logical(name: str) -> Call:
    """Make np.logical_and or np.logical_or."""

    def call(meter: Meter, a: Value, b: Value) -> Value:
        def apply(x: Value, y: Value) -> Value:
            return (both if name == "and" else either)(meter, truth(meter, x), truth(meter, y))

        return elementwise(meter, apply, a, b)

    return call


def negation(meter: Meter, value: Value) -> Value:
    """Evaluate np.logical_not."""
    value = as_vector(meter, value)
    return Vec(tuple(negation(meter, item) for item in value.items)) if isinstance(value, Vec) else invert(meter, value)


def round_to(meter: Meter, value: Value, decimals: Value = 0) -> Value:
    """Round the value to some decimals."""
    if not isinstance(decimals, int) or not 0 <= decimals <= 12:
        raise meter.fault("wrong_call", "round takes 0 to 12 decimals")

    def apply(item: Number) -> Number:
        meter.made()
        return unary(lambda x: np.round(x, decimals), item)

    return each(meter, apply, value)


def length(meter: Meter, value: Value) -> Value:
    """Count the entries of a container; contact points count 1 if there are any."""
    if isinstance(value, ContactList):
        return number(meter, value.touching)
    if isinstance(value, Vec | DictValue) or (isinstance(value, Seq) and value.kind not in ONCE):
        return len(value.items)
    raise meter.fault("wrong_type", f"{kind(value)} has no length")


def add_up(meter: Meter, value: Value, start: Value = 0) -> Value:
    """Evaluate Python's sum; an entry that is set in some states only counts as 0 in the others."""
    if not isinstance(value, Seq | Vec):
        raise meter.fault("wrong_type", f"sum takes a list, not {kind(value)}")
    found = start
    for item in entries(meter, value):
        if isinstance(item, Partial):
            item = where(meter, item.mask, item.value, 0.0)
        found = (
            renewed(item)
            if isinstance(found, int) and found == 0 and isinstance(item, Vec)
            else binary(meter, "+", found, item)
        )
    return found
