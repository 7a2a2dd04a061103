"""Assigning to variables and to the entries of dicts; lists and arrays are never changed."""

from __future__ import annotations

import ast
from typing import Any

from coral.contact.cost_program.binding import checked_key, hold, unpack
from coral.contact.cost_program.expressions import SYMBOLS, evaluate, operate
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.subscripts import subscript
from coral.contact.cost_program.values import NUMBER, DictValue, Value, bounded, kind


def assign_to(machine: Machine, target: ast.expr, value: Value) -> None:
    """Assign a value to a target of an assignment or loop."""
    if isinstance(target, ast.Subscript):
        _set_entry(machine, target, value)
    else:
        unpack(machine, target, value)


def _set_entry(machine: Machine, target: ast.Subscript, value: Value) -> None:
    """Run `name[key] = value`, by binding the name to the changed dict.

    Raises:
        CostError: It is not a dict of this function that has one name.
    """
    fault, name = machine.meter.fault, target.value
    base = evaluate(machine, name)
    machine.meter.line = target.lineno
    if not isinstance(base, DictValue):
        raise fault("not_allowed", f"entries of {kind(base)} cannot be set; make a new one, as with np.array([...])")
    if not isinstance(name, ast.Name) or name.id not in machine.frame.variables:
        raise fault("not_allowed", "only the entries of a function's own dicts can be set, under their own name")
    if base.shared:
        raise fault("shared", f"{name.id!r} would change under another name, too; write the dict a second time")
    key = checked_key(machine, evaluate(machine, target.slice))
    changed = DictValue({**base.items, key: hold(machine, value)}, named=True)
    machine.frame.variables[name.id] = bounded(machine.meter, changed)


def assign(machine: Machine, node: Any) -> bool:
    """Run `x = value`."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if node.value is not None:
        value = evaluate(machine, node.value)
        for target in targets:
            assign_to(machine, target, value)
    return True


def augment(machine: Machine, node: Any) -> bool:
    """Run `x += value`, of a number or of the entry of a dict that is one.

    Raises:
        CostError: The variable is not set, or no number, which would change under all its names.
    """
    target, fault = node.target, machine.meter.fault
    if isinstance(target, ast.Name):
        if target.id not in machine.frame.variables:
            raise fault("unset", f"{target.id!r} has no value before it is changed; begin with {target.id} = 0.0")
        old = machine.lookup(target.id)
    elif isinstance(target, ast.Subscript):
        old = subscript(machine, evaluate(machine, target.value), target.slice, evaluate)
    else:
        raise fault("not_allowed", "the state cannot be changed; use a variable of your own")
    right = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    array = isinstance(old, NUMBER) and any(old is held for held in machine.meter.zero_axes)
    if array or not isinstance(old, NUMBER):
        name, symbol = ast.unparse(target), SYMBOLS.get(type(node.op), "@")
        raise fault("shared", f"{kind(old)} would change under all its names; write {name} = {name} {symbol} ...")
    assign_to(machine, target, operate(machine, node.op, old, right))
    return True
