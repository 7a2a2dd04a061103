"""Assigning to entries: the result of `v[0] = x`, `m[:, 1] = v` or `terms["reach"] = x`."""

from __future__ import annotations

import ast

from coral.contact.cost_program.arithmetic import as_vector, is_truth, number
from coral.contact.cost_program.arrays import shape_of
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.sharing import marks_of, renewed
from coral.contact.cost_program.subscripts import Evaluate, Index, entry, index, index_key, indices
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, bounded, is_matrix, kind


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
    if isinstance(base, Seq):
        if base.kind != "list":
            raise meter.fault("wrong_type", f"the entries of {kind(base)} cannot be set")
        return _in_list(machine, base, index(machine, base, node, evaluate), value)
    if not isinstance(base, Vec):
        raise meter.fault("wrong_type", f"the entries of {kind(base)} cannot be set")
    axes = indices(machine, base, node, evaluate)
    if inside and isinstance(value, Vec) and axes and isinstance(axes[0], int) and len(axes) == 1:
        i = axes[0] % len(base.items)
        return Vec((*base.items[:i], value, *base.items[i + 1 :]), "", marks_of(base)), axes[0]
    if None in axes:
        raise meter.fault("wrong_size", "a new axis cannot be set")
    found = as_vector(meter, value)
    only = axes[0] if len(axes) == 1 and isinstance(axes[0], int) else None
    return _along(machine, base, axes, found), only


def _in_list(machine: Machine, base: Seq, where: Index, value: Value) -> tuple[Seq, Value]:
    items = list(base.items)
    if isinstance(where, int):
        entry(machine, base, where)
        items[where] = value
    elif isinstance(where, slice):
        span = range(*where.indices(len(items)))
        parts = value.items if isinstance(value, Vec | Seq) else ()
        if len(parts) != len(span):
            raise machine.meter.fault("wrong_size", f"{len(parts)} values do not fill {len(span)} entries")
        for i, part in zip(span, parts, strict=True):
            items[i] = part
    else:
        raise machine.meter.fault("not_fixed", "an index is a constant whole number")
    changed = Seq(tuple(items), "list", marks_of(base))
    bounded(machine.meter, changed)
    return changed, where if isinstance(where, int) else None


def _along(machine: Machine, base: Vec, axes: list[Index], value: Value) -> Vec:
    """Set the entries at the given indices of each axis to a value, broadcast as in NumPy."""
    where, inner = (axes[0] if axes else slice(None)), axes[1:]
    items = list(base.items)
    parts: tuple[Value, ...] = (value,)
    if isinstance(where, int):
        entry(machine, base, where)
        span = [where]
    else:
        span = list(_span(machine, base, where))
        parts = _values_for_entries(
            machine, value, len(span), is_matrix(base) and not (inner and isinstance(inner[0], int))
        )
    for i, part in zip(span, parts, strict=True):
        old = entry(machine, base, i)
        if isinstance(old, Vec):
            items[i] = _along(machine, old, inner, part)
        else:
            items[i] = _number_for(machine, base, part)
    return Vec(tuple(items), "", marks_of(base))


def _span(machine: Machine, base: Vec, where: Index) -> range | tuple[int, ...]:
    if isinstance(where, slice):
        return range(*where.indices(len(base.items)))
    if isinstance(where, tuple):
        return where
    raise machine.meter.fault("not_fixed", "an index is a constant whole number")


def _values_for_entries(machine: Machine, value: Value, count: int, rows: bool) -> tuple[Value, ...]:
    """Return the value for each of several entries; a plain vector is the value for every row."""
    if isinstance(value, Vec) and (is_matrix(value) or not rows):
        if len(value.items) == 1:
            return value.items * count
        if len(value.items) != count:
            raise machine.meter.fault("wrong_size", f"{kind(value)} does not fill {count} entries")
        return value.items
    return (value,) * count


def _number_for(machine: Machine, base: Vec, value: Value) -> Value:
    """Convert a number to the kind that the array holds.

    Raises:
        CostError: It is not a number, or NumPy would cut off its decimals.
    """
    found = number(machine.meter, renewed(value))
    if base.items and all(map(is_truth, base.items)):
        raise machine.meter.fault("wrong_type", "entries of an array of truth values cannot be set; use a list")
    if all(isinstance(item, int) for item in base.items):
        if not isinstance(found, int):
            raise machine.meter.fault(
                "wrong_type", "NumPy would cut off the decimals in this array of whole numbers; begin with 0.0, not 0"
            )
        return found
    return float(found) if isinstance(found, int) else found


def same_shape(meter: Meter, old: Vec, new: Value) -> Vec:
    """Return the result of `old += ...` in the memory of `old`.

    Raises:
        CostError: It has another shape, or NumPy would cut off the decimals.
    """
    if not isinstance(new, Vec) or shape_of(old).items != shape_of(new).items:
        raise meter.fault("wrong_size", f"{kind(old)} cannot become {kind(new)} in place; write v = v + w")
    items: list[Value] = []
    for before, after in zip(old.items, new.items, strict=True):
        if isinstance(before, Vec):
            items.append(same_shape(meter, before, after))
        elif isinstance(before, int) and not isinstance(after, int):
            raise meter.fault("wrong_type", "NumPy refuses decimals in an array of whole numbers; begin with 0.0")
        else:
            items.append(float(after) if isinstance(after, int) and not isinstance(before, int) else after)
    return Vec(tuple(items), new.order, marks_of(old))
