"""Binding of values to names, and the checks of a value or key before it is stored."""

from __future__ import annotations

import ast

from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.values import Seq, Value, kind


def storable(machine: Machine, value: Value) -> Value:
    """Check a value before it is bound to a name or stored in a container.

    Raises:
        CostError: It is a generator, whose values Python would compute only later.
    """
    if isinstance(value, Seq) and value.kind == "generator":
        raise machine.meter.fault("wrong_type", "a generator is used where it is made; write a list, [x for x in xs]")
    return value


def checked_key(machine: Machine, key: Value) -> Value:
    """Return the key of a dict, checked.

    Raises:
        CostError: It is not a constant text or whole number.
    """
    if isinstance(key, str | int) and not isinstance(key, bool):
        return key
    raise machine.meter.fault("wrong_type", f"the keys of a dict are constant texts or whole numbers, not {kind(key)}")


def unpack(machine: Machine, target: ast.expr, value: Value) -> None:
    """Bind the name, or the names of a tuple, of an assignment or loop.

    Raises:
        CostError: The target is no name, or the lengths differ.
    """
    if isinstance(target, ast.Name):
        machine.frame.variables[target.id] = storable(machine, value)
        return
    if not isinstance(target, ast.Tuple | ast.List):
        raise machine.meter.fault(
            "not_allowed",
            "only variables and entries of the program's own lists, dicts and "
            "arrays can be set; the state cannot be changed",
        )
    items = entries(machine.meter, value)
    if any(isinstance(part, ast.Starred) for part in target.elts) or len(items) != len(target.elts):
        raise machine.meter.fault("wrong_size", f"{len(target.elts)} names cannot take {len(items)} values")
    for part, item in zip(target.elts, items, strict=True):
        unpack(machine, part, item)
