"""Creating and rearranging arrays: np.array, np.zeros, np.concatenate, reshape and the like."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from coral.contact.cost_program.arithmetic import as_vector, components, each, number, transposed
from coral.contact.cost_program.functions import flat
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.sharing import renewed, view
from coral.contact.cost_program.values import (
    NUMBER,
    BodyHandle,
    DictValue,
    Number,
    Seq,
    Value,
    Vec,
    bounded,
    is_matrix,
    is_one_of,
    kind,
)


def array(meter: Meter, value: Value, dtype: Value = None, copy: Value = None) -> Value:
    """Make a new vector or matrix from a list, tuple or vector; a number stays a number."""
    if copy is False and isinstance(value, Vec):
        return value
    found = as_vector(meter, value)
    if isinstance(found, Vec):
        return _of_one_kind(found, dtype is not None)
    return number(meter, found) if not isinstance(found, bool | np.ndarray) else found


def _of_one_kind(value: Vec, floats: bool) -> Vec:
    """Make a new array whose entries are all floats if one of them is, as NumPy stores them."""
    whole = not floats and all(isinstance(item, int) for item in _leaves(value))

    def renew(item: Value) -> Value:
        if isinstance(item, Vec):
            return Vec(tuple(renew(part) for part in item.items), item.order)
        return float(item) if isinstance(item, int) and not isinstance(item, bool) and not whole else item

    found = renew(value)
    assert isinstance(found, Vec)
    return found


def _leaves(value: Vec) -> Iterator[Value]:
    for item in value.items:
        if isinstance(item, Vec):
            yield from _leaves(item)
        else:
            yield item


def asarray(meter: Meter, value: Value, dtype: Value = None) -> Value:
    """Return the vector itself, or a new one made from a list."""
    return value if isinstance(value, Vec) and dtype is None else array(meter, value, dtype)


def to_float(meter: Meter, value: Value = 0.0) -> Value:
    """Evaluate `float(...)`: a number stays one, a truth value becomes 0 or 1, "inf" becomes infinity."""
    if isinstance(value, str):
        if value.strip().lower().lstrip("+-") in ("inf", "infinity"):
            return -math.inf if value.strip().startswith("-") else math.inf
        raise meter.fault("wrong_type", "float takes a number")
    found = number(meter, value)
    return float(found) if isinstance(found, int) else found


def to_int(meter: Meter, value: Value = 0) -> Value:
    """Evaluate `int(...)`: drop the fractional part."""
    found = number(meter, value)
    if isinstance(found, float):
        if not math.isfinite(found):
            raise meter.fault("wrong_type", "int takes a finite number")
        return int(found)
    if isinstance(found, np.ndarray):
        meter.made()
        return np.trunc(found)
    return found


def as_type(meter: Meter, value: Value, dtype: Value = None, copy: Value = None) -> Value:
    """Evaluate `astype(float)`: truth values become numbers."""
    if copy is False:
        return value

    def change(item: Number) -> Number:
        return float(item) if isinstance(item, int) else item

    return each(meter, change, value)


def _size(meter: Meter, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= meter.cfg.items:
        return value
    raise meter.fault("not_fixed", f"a size is a whole number from 0 to {meter.cfg.items}")


def full(meter: Meter, shape: Value, fill_value: Value, dtype: Value = None) -> Value:
    """Make a vector (n) or matrix ((m, n)) filled with one number."""
    sizes = [_size(meter, item) for item in (shape.items if isinstance(shape, Seq) else (shape,))]
    if not 1 <= len(sizes) <= 2 or math.prod(sizes) > meter.cfg.items:
        raise meter.fault("wrong_size", f"an array has one or two axes and at most {meter.cfg.items} entries")
    fill = number(meter, fill_value)
    row: tuple[Value, ...] = (fill if dtype is None else to_float(meter, fill),) * sizes[-1]
    return Vec(row) if len(sizes) == 1 else Vec(tuple(Vec(row) for _ in range(sizes[0])))


def zeros(meter: Meter, shape: Value, dtype: Value = None) -> Value:
    """Make a vector or matrix of zeros."""
    return full(meter, shape, 0.0)


def ones(meter: Meter, shape: Value, dtype: Value = None) -> Value:
    """Make a vector or matrix of ones."""
    return full(meter, shape, 1.0)


def like(fill: float) -> Callable[..., Value]:
    """Evaluate np.zeros_like or np.ones_like."""

    def call(meter: Meter, value: Value, dtype: Value = None) -> Value:
        return each(meter, lambda item: int(fill) if isinstance(item, int) and dtype is None else fill, value)

    return call


def eye(meter: Meter, n: Value, dtype: Value = None) -> Value:
    """Make the identity matrix."""
    size = _size(meter, n)
    if size > 8:
        raise meter.fault("wrong_size", "eye takes at most 8")
    return Vec(tuple(Vec(tuple(float(i == j) for j in range(size))) for i in range(size)))


def concatenate(meter: Meter, arrays: Value, axis: Value = 0) -> Value:
    """Concatenate vectors."""
    if not is_one_of(axis, (0, -1)) or not isinstance(arrays, Seq | Vec):
        raise meter.fault("wrong_call", "concatenate takes a list of vectors and axis 0")
    parts = [asarray(meter, part) for part in arrays.items]
    found: tuple[Value, ...] = ()
    for part in parts:
        found += part.items if isinstance(part, Vec) else (part,)
    result = as_vector(meter, Seq(found))
    return bounded(meter, renewed(result))


def append(meter: Meter, arr: Value, values: Value) -> Value:
    """Return all numbers of both in one new vector."""
    return bounded(meter, Vec((*flat(meter, arr), *flat(meter, values))))


def stack(meter: Meter, arrays: Value, axis: Value = 0) -> Value:
    """Stack vectors as the rows (axis 0) or columns (axis 1) of a matrix."""
    if not isinstance(arrays, Seq | Vec):
        raise meter.fault("wrong_call", "stack takes a list of vectors")
    found = as_vector(meter, Seq(tuple(arrays.items)))
    if not isinstance(found, Vec) or not is_one_of(axis, (0, 1, -1)):
        raise meter.fault("wrong_call", "stack takes a list of vectors and axis 0 or 1")
    return renewed(transposed(meter, found) if axis != 0 else found)


def reshape(meter: Meter, value: Value, *shape: Value) -> Value:
    """Return the same numbers as a vector or as the rows of a matrix."""
    sizes = shape[0].items if len(shape) == 1 and isinstance(shape[0], Seq) else shape
    items = flat(meter, value)
    if not 1 <= len(sizes) <= 2 or not all(isinstance(n, int) and (n > 0 or n == -1) for n in sizes):
        raise meter.fault("wrong_size", "reshape takes one or two whole numbers")
    wanted = [int(number(meter, n)) for n in sizes]
    if -1 in wanted:
        rest = math.prod(n for n in wanted if n != -1)
        wanted[wanted.index(-1)] = len(items) // rest if rest else 0
    if any(n <= 0 for n in wanted) or math.prod(wanted) != len(items):
        raise meter.fault("wrong_size", f"{len(items)} numbers do not fill the shape {tuple(wanted)}")
    if len(wanted) == 1:
        return view(items, value)
    columns = wanted[1]
    rows = (view(items[i * columns : (i + 1) * columns], value) for i in range(wanted[0]))
    return view(tuple(rows), value)


def ravel(meter: Meter, value: Value) -> Value:
    """Return all numbers as one vector that shares memory with the array."""
    return view(flat(meter, value), value)


def flatten(meter: Meter, value: Value) -> Value:
    """Return all numbers as a vector with its own memory."""
    return Vec(flat(meter, value))


def squeezed(meter: Meter, value: Value) -> Value:
    """Return the array without its axes of length 1; it shares memory with the array."""
    found = as_vector(meter, value)
    if not isinstance(found, Vec):
        return found
    if len(found.items) == 1:
        only = found.items[0]
        if isinstance(only, Vec) and len(only.items) > 1:
            return only
        raise meter.fault("wrong_size", "an array of one number is not squeezed here; write its entry, as v[0]")
    if is_matrix(found) and all(isinstance(row, Vec) and len(row.items) == 1 for row in found.items):
        return ravel(meter, found)
    return found


def to_list(meter: Meter, value: Value) -> Value:
    """Evaluate `tolist()`: a list of numbers, or for a matrix a list of lists."""
    if not isinstance(value, Vec):
        return value
    return Seq(tuple(to_list(meter, item) for item in value.items))


def transpose(meter: Meter, value: Value) -> Value:
    """Swap rows and columns."""
    found = as_vector(meter, value)
    return transposed(meter, found) if isinstance(found, Vec) else found


def diag(meter: Meter, value: Value) -> Value:
    """Return the diagonal of a matrix, or the matrix with a given diagonal."""
    found = as_vector(meter, value)
    if is_matrix(found):
        assert isinstance(found, Vec)
        rows = [components(meter, row) for row in found.items]
        return Vec(tuple(row[i] for i, row in enumerate(rows) if i < len(row)))
    items = components(meter, found)
    if len(items) > 8:
        raise meter.fault("wrong_size", "diag takes at most 8")
    return Vec(tuple(Vec(tuple(item if i == j else 0.0 for j in range(len(items)))) for i, item in enumerate(items)))


def shape_of(value: Value) -> Seq:
    """Return the shape that NumPy would report for one state."""
    if isinstance(value, Vec):
        first = value.items[0] if value.items else None
        return Seq((len(value.items), len(first.items)) if isinstance(first, Vec) else (len(value.items),), "tuple")
    return Seq((), "tuple")


def copied(meter: Meter, value: Value) -> Value:
    """Return a copy that can be changed without changing the original; of a list, an array, as np.copy does."""
    if isinstance(value, Vec):
        return renewed(value)
    if isinstance(value, Seq):
        return array(meter, value)
    if isinstance(value, DictValue):
        return DictValue(dict(value.items))
    if isinstance(value, NUMBER) or value is None or isinstance(value, BodyHandle):
        return value
    raise meter.fault("wrong_type", f"{kind(value)} cannot be copied")
