"""Reading entries: `v[0]`, `v[:2]`, `xs[-1]`, `weights["reach"]`."""

from __future__ import annotations

import ast
from collections.abc import Callable

from coral.contact.cost_program.binding import checked_key
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, kind

Evaluate = Callable[[Machine, ast.expr], Value]


def subscript(machine: Machine, base: Value, node: ast.expr, evaluate: Evaluate) -> Value:
    """Evaluate `base[node]`.

    Raises:
        CostError: There is no such entry, or the index depends on the state.
    """
    fault = machine.meter.fault
    if isinstance(base, DictValue):
        key = checked_key(machine, evaluate(machine, node))
        if key not in base.items:
            known = ", ".join(ascii(name) for name in base.items)
            raise fault("wrong_size", f"the dict has no {key!r}; it has {known or 'nothing'}")
        return machine.usable(base.items[key], str(key))
    if not isinstance(base, Vec | Seq) or (isinstance(base, Seq) and base.kind == "iterator"):
        raise fault("wrong_type", f"{kind(base)} has no numbered entries")
    if isinstance(node, ast.Slice):
        ends = [_whole(machine, evaluate(machine, end)) if end else None for end in (node.lower, node.upper, node.step)]
        if ends[2] == 0:
            raise fault("wrong_size", "the step of a slice is not 0")
        items = base.items[slice(*ends)]
        if isinstance(base, Seq):
            return Seq(items, base.kind)
        if not items:
            raise fault("wrong_size", "an array has at least one entry")
        machine.meter.spend(len(items))
        return Vec(items)
    if isinstance(node, ast.Tuple):
        raise fault("wrong_type", f"{kind(base)} has one axis")
    where = _whole(machine, evaluate(machine, node))
    if not -len(base.items) <= where < len(base.items):
        raise fault("wrong_size", f"{kind(base)} has no entry {where}")
    return machine.usable(base.items[where], f"[{where}]")


def _whole(machine: Machine, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise machine.meter.fault(
        "not_fixed",
        f"an index is a constant whole number, not {kind(value)}; to pick by a condition on the state use np.where",
    )
