"""Assigning to entries: the result of `v[0] = x`, `m[:, 1] = v` or `terms["reach"] = x`."""

from __future__ import annotations

import ast

import numpy as np

from coral.contact.cost_program.arithmetic import as_vector
from coral.contact.cost_program.arrays import flat, places, shape, to_float
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.merging import TWO_KINDS
from coral.contact.cost_program.scalars import is_truth, is_whole, number
from coral.contact.cost_program.sharing import marks_of
from coral.contact.cost_program.subscripts import Evaluate, Index, index, index_key, indices, picked
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, bounded, kind


def replaced(
    machine: Machine, base: Value, node: ast.expr, value: Value, evaluate: Evaluate, inside: bool = False
) -> tuple[Vec | Seq | DictValue, Value]:
    """Set entries of a container; return the new container, and the index or key if a single entry was set.

    Args:
        machine: The evaluation.
        base: The container.
        node: The index.
        value: The new value.
        evaluate: Evaluates an expression.
        inside: Whether the value is the same entry after a change inside it, which keeps its memory.

    Raises:
        CostError: There is no such entry, or the value does not fit in it.
    """
    meter = machine.meter
    if isinstance(base, DictValue):
        key = index_key(machine, base, node, evaluate)
        changed = DictValue({**base.items, key: value}, marks_of(base))
        bounded(meter, changed)
        return changed, key
    if isinstance(base, Seq) and base.kind == "list":
        return _in_list(machine, base, index(machine, base, node, evaluate), value)
    if not isinstance(base, Vec):
        raise meter.fault("wrong_type", f"the entries of {kind(base)} cannot be set")
    parts = indices(machine, base, node, evaluate)
    only = parts[0] if len(parts) == 1 and isinstance(parts[0], int) else None
    if inside and isinstance(value, Vec) and only is not None:
        i = only % len(base.items)
        return Vec((*base.items[:i], value, *base.items[i + 1 :]), "", marks_of(base)), only
    return _in_array(machine, base, parts, as_vector(meter, value)), only


def _in_list(machine: Machine, base: Seq, where: Index, value: Value) -> tuple[Seq, Value]:
    items = list(base.items)
    if not isinstance(where, int):
        raise machine.meter.fault("wrong_type", "entries of a list are set one by one, as xs[0] = x")
    if not -len(items) <= where < len(items):
        raise machine.meter.fault("wrong_size", f"{kind(base)} has no entry {where}")
    items[where] = value
    changed = Seq(tuple(items), "list", marks_of(base))
    bounded(machine.meter, changed)
    return changed, where


def _in_array(machine: Machine, base: Vec, parts: list[Index], value: Value) -> Vec:
    """Let NumPy find the entries to set, and those of the value that go there."""
    at, given, entries = picked(machine, base, parts), flat(value), list(flat(base))
    try:
        source = np.broadcast_to(places(value), at.shape)
    except ValueError:
        raise machine.meter.fault("wrong_size", f"{kind(value)} does not fit there") from None
    for place, k in zip(at.flat, source.flat, strict=True):
        entries[place] = fitted(machine.meter, base, given[k])
    items = iter(entries)
    rows = (
        Vec(tuple(next(items) for _ in row.items), "", marks_of(row)) if isinstance(row, Vec) else next(items)
        for row in base.items
    )
    return Vec(tuple(rows), "", marks_of(base))


def fitted(meter: Meter, base: Vec, value: Value) -> Value:
    """Convert a number to the kind that the array holds.

    Raises:
        CostError: NumPy would cut off its decimals, or keep only whether it is 0.
    """
    held = flat(base)[0]
    number(meter, value)
    if is_truth(held) or base.order == TWO_KINDS:
        raise meter.fault("wrong_type", "entries of such an array cannot be set; begin with an array of 0.0")
    if not is_whole(held):
        return to_float(meter, value)
    if not is_whole(value):
        raise meter.fault(
            "wrong_type", "NumPy would cut off the decimals in this array of whole numbers; begin with 0.0, not 0"
        )
    return number(meter, value)


def same_shape(meter: Meter, old: Vec, new: Value) -> Vec:
    """Return the result of `old += ...` in the memory of `old`.

    Raises:
        CostError: It has another shape, or NumPy would cut off the decimals.
    """
    if not isinstance(new, Vec) or shape(old) != shape(new):
        raise meter.fault("wrong_size", f"{kind(old)} cannot become {kind(new)} in place; write v = v + w")
    items = tuple(
        same_shape(meter, before, after) if isinstance(before, Vec) else fitted(meter, old, after)
        for before, after in zip(old.items, new.items, strict=True)
    )
    return Vec(items, new.order, marks_of(old))
