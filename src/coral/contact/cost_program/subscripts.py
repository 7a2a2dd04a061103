"""Reading and replacing entries: `v[0]`, `v[:2]`, `m[1, 2]`, `weights["reach"]`."""

from __future__ import annotations

import ast
from collections.abc import Callable

from coral.contact.cost_program.arithmetic import as_vector, components, number
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, bounded, is_matrix, kind

Evaluate = Callable[[Machine, ast.expr], Value]
Index = int | slice | tuple[int, ...] | str


def subscript(machine: Machine, base: Value, node: ast.expr, evaluate: Evaluate) -> Value:
    """`base[node]`.

    Raises:
        CostError: There is no such entry, or the index depends on the state.
    """
    parts = node.elts if isinstance(node, ast.Tuple) else [node]
    if isinstance(base, DictValue):
        key = evaluate(machine, node)
        return machine.usable(base.items[_known_key(machine, base, key)], str(key))
    if not isinstance(base, Vec | Seq):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entries to index")
    first = index(machine, parts[0], evaluate)
    if len(parts) == 1:
        return _picked(machine, base, first)
    if len(parts) != 2 or not isinstance(base, Vec) or not is_matrix(base):
        raise machine.meter.fault("wrong_size", f"{kind(base)} has one axis")
    second = index(machine, parts[1], evaluate)
    rows = _picked(machine, base, first)
    if isinstance(first, int):
        return _picked(machine, rows, second)
    assert isinstance(rows, Vec)
    return Vec(tuple(_picked(machine, row, second) for row in rows.items))


def index(machine: Machine, node: ast.expr, evaluate: Evaluate) -> Index:
    """The index that a node stands for.

    Raises:
        CostError: It depends on the state.
    """
    if isinstance(node, ast.Slice):
        ends = [
            None if end is None else _whole(machine, evaluate(machine, end))
            for end in (node.lower, node.upper, node.step)
        ]
        if ends[2] == 0:
            raise machine.meter.fault("wrong_size", "the step of a slice is not 0")
        return slice(*ends)
    value = evaluate(machine, node)
    if isinstance(value, Seq | Vec):
        return tuple(_whole(machine, item) for item in value.items)
    if isinstance(value, str):
        return value
    return _whole(machine, value)


def _whole(machine: Machine, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise machine.meter.fault("not_fixed", f"an index is a constant whole number, not {kind(value)}")


def _known_key(machine: Machine, table: DictValue, key: Value) -> Value:
    if not isinstance(key, str | int):
        raise machine.meter.fault("not_fixed", f"the key of a dict is a constant text, not {kind(key)}")
    if key not in table.items:
        known = ", ".join(repr(name) for name in table.items)
        raise machine.meter.fault("wrong_size", f"the dict has no {key!r}; it has {known or 'nothing'}")
    return key


def _picked(machine: Machine, base: Value, where: Index) -> Value:
    if not isinstance(base, Vec | Seq):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entries to index")
    if isinstance(where, str):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entry {where!r}; entries are numbered")
    items = base.items
    if isinstance(where, slice):
        kept = items[where]
        return Vec(kept, base) if isinstance(base, Vec) else Seq(kept, base.kind)
    if isinstance(where, tuple):
        if not isinstance(base, Vec):
            raise machine.meter.fault("wrong_type", "a list of indices applies to arrays; use np.array")
        return Vec(tuple(_entry(machine, base, i) for i in where))
    return machine.usable(_entry(machine, base, where), f"[{where}]")


def _entry(machine: Machine, base: Vec | Seq, i: int) -> Value:
    if not -len(base.items) <= i < len(base.items):
        raise machine.meter.fault("wrong_size", f"{kind(base)} has no entry {i}")
    return base.items[i]


def replaced(machine: Machine, base: Value, node: ast.expr, value: Value, evaluate: Evaluate) -> Value:
    """The container with one entry, or one slice of a vector, set to a value.

    Raises:
        CostError: There is no such entry, or the value does not fit in it.
    """
    if isinstance(base, DictValue):
        key = evaluate(machine, node)
        if not isinstance(key, str | int) or isinstance(key, bool):
            raise machine.meter.fault("not_fixed", f"the key of a dict is a constant text, not {kind(key)}")
        return bounded(machine.meter, DictValue({**base.items, key: value}))
    if not isinstance(base, Vec | Seq):
        raise machine.meter.fault("wrong_type", f"the entries of {kind(base)} cannot be set")
    if isinstance(base, Seq) and base.kind == "tuple":
        raise machine.meter.fault("wrong_type", "the entries of a tuple cannot be set")
    if isinstance(node, ast.Tuple) and len(node.elts) == 2 and is_matrix(base):
        row = index(machine, node.elts[0], evaluate)
        if not isinstance(row, int):
            raise machine.meter.fault("not_fixed", "one entry or one row of a matrix can be set at a time")
        line = replaced(machine, _entry(machine, base, row), node.elts[1], value, evaluate)
        return _with(base, row, line, machine)
    where = index(machine, node, evaluate)
    if isinstance(where, slice):
        span = range(*where.indices(len(base.items)))
        wanted = as_vector(machine.meter, value)
        parts = components(machine.meter, wanted) if isinstance(wanted, Vec) else (wanted,) * len(span)
        if len(parts) != len(span):
            raise machine.meter.fault("wrong_size", f"{len(parts)} values do not fill {len(span)} entries")
        found: Value = base
        for i, part in zip(span, parts, strict=True):
            found = _with(found, i, part, machine)
        return found
    if not isinstance(where, int):
        raise machine.meter.fault("not_fixed", "an index is a constant whole number")
    return _with(base, where, value, machine)


def _with(base: Value, i: int, value: Value, machine: Machine) -> Value:
    assert isinstance(base, Vec | Seq)
    old = _entry(machine, base, i)
    if isinstance(base, Vec):
        if isinstance(old, Vec) != isinstance(value, Vec) or (
            isinstance(old, Vec) and isinstance(value, Vec) and len(old.items) != len(value.items)
        ):
            raise machine.meter.fault("wrong_size", f"{kind(value)} does not fit into an entry of {kind(base)}")
        if not isinstance(value, Vec):
            value = number(machine.meter, value)
    i %= len(base.items)
    items = (*base.items[:i], value, *base.items[i + 1 :])
    return bounded(machine.meter, Vec(items) if isinstance(base, Vec) else Seq(items, base.kind))
