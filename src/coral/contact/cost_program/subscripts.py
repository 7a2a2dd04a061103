"""Reading entries: `v[0]`, `v[:2]`, `m[1, 2]`, `a[..., 2]`, `v[:, None]`, `weights["reach"]`."""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import EllipsisType

from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.sharing import LAZY, memory, renewed
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, is_matrix, kind

Evaluate = Callable[[Machine, ast.expr], Value]
Index = int | slice | tuple[int, ...] | str | EllipsisType | None
"""Index of one axis: an entry, a slice, a list of entries, a key; `...`; None for a new axis."""


def subscript(machine: Machine, base: Value, node: ast.expr, evaluate: Evaluate) -> Value:
    """Evaluate `base[node]`.

    Raises:
        CostError: There is no such entry, or the index depends on the state.
    """
    if isinstance(base, DictValue):
        key = index_key(machine, base, node, evaluate)
        if key not in base.items:
            known = ", ".join(ascii(name) for name in base.items)
            raise machine.meter.fault("wrong_size", f"the dict has no {key!r}; it has {known or 'nothing'}")
        return machine.usable(base.items[key], str(key))
    if not isinstance(base, Vec):
        if not isinstance(base, Seq):
            raise machine.meter.fault("wrong_type", f"{kind(base)} has no entries to index")
        return _pick(machine, base, index(machine, base, node, evaluate))
    parts = indices(machine, base, node, evaluate)
    axes: list[Index] = [part for part in parts if part is not None]
    kept = ["axis" if part is not None else "new" for part in parts if not isinstance(part, int)]
    kept += ["axis"] * (depth(base) - len(axes))
    found = _entries(machine, base, axes)
    if "new" not in kept:
        return found
    return _with_new_axes(machine, found, kept)


def _entries(machine: Machine, base: Vec, axes: list[Index]) -> Value:
    """Return the entries that the indices of one or two axes select."""
    if not axes:
        return base
    first = axes[0]
    rows = _pick(machine, base, first)
    if len(axes) == 1:
        return rows
    second = axes[1]
    if isinstance(first, int):
        return _pick(machine, rows, second)
    assert isinstance(rows, Vec)
    if isinstance(first, tuple) and isinstance(second, tuple):  # pairs, as in NumPy
        if len(first) != len(second):
            raise machine.meter.fault("wrong_size", f"{len(first)} row and {len(second)} column indices do not match")
        return Vec(tuple(_pick(machine, row, i) for row, i in zip(rows.items, second, strict=True)))
    marks = memory(base) if isinstance(second, slice | int) else None
    return Vec(tuple(_pick(machine, row, second) for row in rows.items), "", marks)


def _with_new_axes(machine: Machine, found: Value, kept: list[str]) -> Value:
    if len(kept) > 2:
        raise machine.meter.fault("wrong_size", "an array has one or two axes")
    if not isinstance(found, Vec):
        row = Vec((found,))
        return row if len(kept) == 1 else Vec((row,))
    if kept[0] == "new":
        return Vec((found,))
    return Vec(tuple(Vec((item,)) for item in found.items), "", memory(found))


def depth(value: Value) -> int:
    """Count the axes of an array."""
    return 2 if is_matrix(value) else 1


def index_key(machine: Machine, table: DictValue, node: ast.expr, evaluate: Evaluate) -> Value:
    """Evaluate a node as a dict key.

    Raises:
        CostError: It is not a constant text or whole number.
    """
    machine.pending.append(table)
    key = evaluate(machine, node)
    machine.pending.pop()
    if isinstance(key, str | int) and not isinstance(key, bool):
        return key
    raise machine.meter.fault("not_fixed", f"the key of a dict is a constant text, not {kind(key)}")


def indices(machine: Machine, base: Vec, node: ast.expr, evaluate: Evaluate) -> list[Index]:
    """Evaluate the index of each axis, with `...` expanded and None for each new axis.

    Raises:
        CostError: There are more indices than axes.
    """
    nodes = node.elts if isinstance(node, ast.Tuple) else [node]
    parts = [index(machine, base, part, evaluate) for part in nodes]
    given = sum(part is not None and part is not ... for part in parts)
    if given > depth(base) or sum(part is ... for part in parts) > 1:
        raise machine.meter.fault("wrong_size", f"{kind(base)} has {'two axes' if depth(base) == 2 else 'one axis'}")
    found: list[Index] = []
    for part in parts:
        if part is ...:
            found += [slice(None)] * (depth(base) - given)
        else:
            found.append(part)
    return found


def index(machine: Machine, base: Value, node: ast.expr, evaluate: Evaluate) -> Index:
    """Evaluate a node as an index.

    Raises:
        CostError: The index depends on the state.
    """
    if isinstance(node, ast.Constant) and (node.value is None or node.value is ...) and isinstance(base, Vec):
        return node.value
    machine.pending.append(base)
    try:
        if isinstance(node, ast.Slice):
            ends = [
                None if end is None else _slice_end(machine, evaluate(machine, end))
                for end in (node.lower, node.upper, node.step)
            ]
            if ends[2] == 0:
                raise machine.meter.fault("wrong_size", "the step of a slice is not 0")
            return slice(*ends)
        if isinstance(node, ast.Tuple):
            raise machine.meter.fault("wrong_type", f"{kind(base)} has one axis")
        value = evaluate(machine, node)
    finally:
        machine.pending.pop()
    if value is None and isinstance(base, Vec):
        return None
    if (isinstance(value, Seq) and value.kind in ("list", "range")) or isinstance(value, Vec):
        return tuple(_whole(machine, item) for item in value.items)
    if isinstance(value, str):
        return value
    return _whole(machine, value)


def _slice_end(machine: Machine, value: Value) -> int | None:
    return None if value is None else _whole(machine, value)


def _whole(machine: Machine, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise machine.meter.fault(
        "not_fixed",
        f"an index is a constant whole number, not {kind(value)}; to pick by a condition on the state use np.where",
    )


def _pick(machine: Machine, base: Value, where: Index) -> Value:
    if not isinstance(base, Vec | Seq):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entries to index")
    if isinstance(base, Seq) and base.kind in (*LAZY, "set"):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no numbered entries; write list(...) around it")
    if isinstance(where, str) or where is None or where is ...:
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entry {where!r}; entries are numbered")
    items = base.items
    if isinstance(where, slice):
        kept = items[where]
        return Vec(kept, "", memory(base)) if isinstance(base, Vec) else Seq(kept, base.kind)
    if isinstance(where, tuple):
        if not isinstance(base, Vec):
            raise machine.meter.fault("wrong_type", "a list of indices applies to arrays; use np.array")
        return Vec(tuple(renewed(entry(machine, base, i)) for i in where))
    return machine.usable(entry(machine, base, where), f"[{where}]")


def entry(machine: Machine, base: Vec | Seq, i: int) -> Value:
    """Resolve the index of an entry; negative ones count from the end.

    Raises:
        CostError: There is no such entry.
    """
    if not -len(base.items) <= i < len(base.items):
        raise machine.meter.fault("wrong_size", f"{kind(base)} has no entry {i}")
    return base.items[i]
