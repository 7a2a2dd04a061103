"""Reading entries: `v[0]`, `v[:2]`, `m[1, 2]`, `a[..., :2]`, `v[:, None]`, `weights["reach"]`."""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import EllipsisType
from typing import Any

import numpy as np

from coral.contact.cost_program.arrays import Places, arranged, flat, places
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.sharing import LAZY, renewed, view
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, is_matrix, kind

Evaluate = Callable[[Machine, ast.expr], Value]
Index = int | slice | list[int] | EllipsisType | None
"""Index of one axis: an entry, a slice, a list of entries; `...`; None for a new axis."""


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
    if isinstance(base, Seq):
        return _of_list(machine, base, index(machine, base, node, evaluate))
    if not isinstance(base, Vec):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entries to index")
    parts = indices(machine, base, node, evaluate)
    if len(parts) == 1 and isinstance(parts[0], int) and -len(base.items) <= parts[0] < len(base.items):
        return base.items[parts[0]]
    return _of_array(machine, base, parts)


def _of_list(machine: Machine, base: Seq, where: Index) -> Value:
    if base.kind in LAZY:
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no numbered entries; write list(...) around it")
    if isinstance(where, slice):
        return Seq(base.items[where], base.kind)
    if not isinstance(where, int):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has no entry {where!r}; entries are numbered")
    if not -len(base.items) <= where < len(base.items):
        raise machine.meter.fault("wrong_size", f"{kind(base)} has no entry {where}")
    return machine.usable(base.items[where], f"[{where}]")


def _of_array(machine: Machine, base: Vec, parts: list[Index]) -> Value:
    """Let NumPy pick the entries; what it would make as a view keeps the memory of its base."""
    at = picked(machine, base, parts)
    if not at.ndim:
        if ... in parts:
            raise machine.meter.fault("wrong_type", "NumPy makes an array without axes of this; leave `...` out")
        return flat(base)[int(at)]
    entries = arranged(machine.meter, lambda _: at, base)
    if any(isinstance(part, list) for part in parts):
        return renewed(entries)
    return view(tuple(view(row.items, base) if isinstance(row, Vec) else row for row in entries.items), base)


def picked(machine: Machine, base: Vec, parts: list[Index]) -> Places:
    """Let NumPy apply indices to the numbers of the entries.

    Raises:
        CostError: There is no such entry.
    """
    key: Any = tuple(parts)
    machine.meter.spend(len(base.items))
    try:
        return np.asarray(places(base)[key])
    except IndexError:
        axes = "two axes" if is_matrix(base) else "one axis"
        text = f"no entry {parts[0]}" if len(parts) == 1 else f"{axes}, and no such entries"
        raise machine.meter.fault("wrong_size", f"{kind(base)} has {text}") from None


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
    """Evaluate the indices of an array, one for each axis that is named."""
    nodes = node.elts if isinstance(node, ast.Tuple) else [node]
    return [index(machine, base, part, evaluate) for part in nodes]


def index(machine: Machine, base: Value, node: ast.expr, evaluate: Evaluate) -> Index:
    """Evaluate a node as an index.

    Raises:
        CostError: The index depends on the state.
    """
    if isinstance(node, ast.Constant) and node.value is ... and isinstance(base, Vec):
        return ...
    if isinstance(node, ast.Tuple):
        raise machine.meter.fault("wrong_type", f"{kind(base)} has one axis")
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
        value = evaluate(machine, node)
    finally:
        machine.pending.pop()
    if value is None and isinstance(base, Vec):
        return None
    if isinstance(base, Vec) and (
        (isinstance(value, Seq) and value.kind in ("list", "range")) or isinstance(value, Vec)
    ):
        return [_whole(machine, item) for item in value.items]
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
