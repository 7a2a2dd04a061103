"""Binding of values to names, and the checks of a value or key before it is stored."""

from __future__ import annotations

import ast

from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.values import DictValue, Seq, Value, entries, kind


def storable(machine: Machine, value: Value) -> Value:
    """Check a value that is put into a list or tuple.

    Raises:
        CostError: It is an iterator, whose values Python would compute only later, and once.
    """
    if isinstance(value, Seq) and value.kind == "iterator":
        raise machine.meter.fault("wrong_type", "an iterator is used where it is made; write list(...) around it")
    return value


def hold(machine: Machine, value: Value) -> Value:
    """Check a value that is bound to a name or put into a dict, and note that its dicts have one more name.

    Raises:
        CostError: It is an iterator.
    """
    if isinstance(value, DictValue):
        value.shared = value.named
        value.named = True
    elif isinstance(value, Seq):
        for item in value.items:
            hold(machine, item)
    return storable(machine, value)


def checked_key(machine: Machine, key: Value) -> Value:
    """Return the key of a dict, checked.

    Raises:
        CostError: It is not a constant text or whole number.
    """
    if isinstance(key, str | int) and not isinstance(key, bool):
        return key
    raise machine.meter.fault("not_fixed", f"the keys of a dict are constant texts or whole numbers, not {kind(key)}")


def unpack(machine: Machine, target: ast.expr, value: Value) -> None:
    """Bind the name, or the names of a tuple, of an assignment or loop.

    Raises:
        CostError: The target is no name, or the lengths differ.
    """
    if isinstance(target, ast.Name):
        machine.frame.variables[target.id] = hold(machine, value)
        return
    if not isinstance(target, ast.Tuple | ast.List):
        raise machine.meter.fault("not_allowed", "only variables and entries of dicts can be set; the state cannot")
    items = entries(machine.meter, value)
    if len(items) != len(target.elts):
        raise machine.meter.fault("wrong_size", f"{len(target.elts)} names cannot take {len(items)} values")
    for part, item in zip(target.elts, items, strict=True):
        unpack(machine, part, item)
