"""Assigning to variables and entries, and changing containers in place."""

from __future__ import annotations

import ast
from typing import Any

from coral.contact.cost_program.binding import storable, unpack
from coral.contact.cost_program.calls import CHANGERS
from coral.contact.cost_program.expressions import evaluate, operate
from coral.contact.cost_program.in_place import check_unshared, is_inside
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.replacing import replaced, same_shape
from coral.contact.cost_program.sharing import marks_of
from coral.contact.cost_program.subscripts import subscript
from coral.contact.cost_program.sums import LEDGER, added, evaluate_sum, forgotten
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, bounded, kind


def change(machine: Machine, node: ast.Call, function: ast.Attribute) -> None:
    """Evaluate `list.append(x)`, `list.extend(xs)` or `dict.update(d)`."""
    base = evaluate(machine, function.value)
    machine.pending.append(base)
    args = [storable(machine, evaluate(machine, item)) for item in node.args]
    named = {k.arg: storable(machine, evaluate(machine, k.value)) for k in node.keywords if k.arg}
    machine.pending.pop()
    machine.meter.line = node.lineno
    if not isinstance(base, CHANGERS[function.attr]) or len(args) > 1 or (isinstance(base, Seq) and len(args) != 1):
        raise machine.meter.fault("wrong_call", f"{function.attr} does not apply to {kind(base)} in this way")
    changed: Value
    if isinstance(base, Seq):
        if base.kind != "list":
            raise machine.meter.fault("wrong_type", f"{kind(base)} cannot be changed")
        more = (args[0],) if function.attr == "append" else entries(machine.meter, args[0])
        changed = Seq(base.items + more, "list", marks_of(base))
    else:
        assert isinstance(base, DictValue)
        other = args[0] if args else DictValue({})
        if not isinstance(other, DictValue):
            raise machine.meter.fault("wrong_call", "update takes a dict")
        changed = DictValue(base.items | other.items | dict(named), marks_of(base))
    bounded(machine.meter, changed)
    check_unshared(machine, base, _root(machine, function.value))
    _rebind(machine, function.value, changed)


def _root(machine: Machine, target: ast.expr) -> str:
    """Return the variable whose value, or whose entry, a statement changes in place.

    Raises:
        CostError: The target is not a variable of the program, or cannot be changed from here.
    """
    while isinstance(target, ast.Subscript):
        target = target.value
    if not isinstance(target, ast.Name):
        raise machine.meter.fault(
            "not_allowed",
            "only the program's own lists, dicts and arrays can be changed, under "
            "their own name; the state cannot be changed",
        )
    owner = machine.owner(target.id)
    if owner is None or not any(owner is frame for frame in machine.stack):
        raise machine.meter.fault("unknown_name", f"{target.id!r} is not a variable that can be changed here")
    if owner is not machine.frame and machine.branching:
        raise machine.meter.fault("shared", f"{target.id!r} of an outer function cannot be changed inside a condition")
    return target.id


def _rebind(machine: Machine, target: ast.expr, new: Value, inside: bool = True) -> None:
    """Bind the changed container to a variable or to an entry of one."""
    if isinstance(target, ast.Subscript):
        holder = evaluate(machine, target.value)
        if inside and not is_inside(new, holder):
            raise machine.meter.fault("shared", "this would change a copy that nobody sees; give the copy a name first")
        changed, _ = replaced(machine, holder, target.slice, new, evaluate, inside)
        _rebind(machine, target.value, changed)
        return
    assert isinstance(target, ast.Name)
    owner = machine.owner(target.id)
    assert owner is not None
    owner.variables[target.id] = new


def assign_to(machine: Machine, target: ast.expr, value: Value) -> None:
    """Assign a value to a target of an assignment or loop."""
    if isinstance(target, ast.Subscript):
        name = _root(machine, target)
        machine.pending.append(value)
        holder = evaluate(machine, target.value)
        machine.meter.line = target.lineno
        changed, at = replaced(machine, holder, target.slice, value, evaluate)
        machine.pending.pop()
        check_unshared(machine, holder, name, at)
        _rebind(machine, target.value, changed)
    else:
        unpack(machine, target, value)
        for name_node in ast.walk(target):
            if machine.frame.entry and isinstance(name_node, ast.Name) and name_node.id in machine.sums:
                forgotten(machine, name_node.id)


def assign(machine: Machine, node: Any) -> bool:
    """Run `x = value`."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if node.value is None:
        return True
    only = targets[0] if len(targets) == 1 else None
    if machine.frame.entry and isinstance(only, ast.Name) and only.id in machine.sums:
        value, ledger = evaluate_sum(machine, node.value, only.id)
        machine.frame.variables[only.id] = storable(machine, value)
        machine.frame.variables[LEDGER + only.id] = ledger
        return True
    value = evaluate(machine, node.value)
    for target in targets:
        assign_to(machine, target, value)
    return True


def augment(machine: Machine, node: Any) -> bool:
    """Run `x += value`."""
    target = node.target
    if isinstance(target, ast.Subscript):
        name = _root(machine, target)
        holder = evaluate(machine, target.value)
        old = subscript(machine, holder, target.slice, evaluate)
        machine.pending.append(holder)
        right = evaluate(machine, node.value)
        machine.pending.pop()
        machine.meter.line = node.lineno
        new = _apply_update(machine, node.op, old, right)
        if isinstance(old, Vec) or (isinstance(old, Seq) and old.kind == "list"):
            check_unshared(machine, old, name)
        elif isinstance(holder, Vec | Seq | DictValue):
            check_unshared(machine, holder, name, replaced(machine, holder, target.slice, new, evaluate)[1])
        _rebind(machine, target, new, inside=isinstance(old, Vec) or (isinstance(old, Seq) and old.kind == "list"))
        return True
    if not isinstance(target, ast.Name):
        raise machine.meter.fault("not_allowed", "the state cannot be changed; use a variable of your own")
    if target.id not in machine.frame.variables:
        raise machine.meter.fault(
            "unset", f"{target.id!r} has no value before it is changed; begin with {target.id} = 0.0"
        )
    old = machine.lookup(target.id)
    if any(old is held for held in machine.meter.zero_axes):
        raise machine.meter.fault(
            "shared", f"np.where makes an array here, which changes under all its names; write {target.id} = ... + ..."
        )
    if isinstance(old, Vec | Seq):
        machine.pending.append(old)
    right = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    if isinstance(old, Vec | Seq):
        machine.pending.pop()
        if isinstance(old, Vec) or old.kind == "list":
            check_unshared(machine, old, target.id)
    machine.frame.variables[target.id] = _apply_update(machine, node.op, old, right)
    if machine.frame.entry and target.id in machine.sums:
        if isinstance(node.op, ast.Add | ast.Sub):
            added(machine, target.id, node.value, right, isinstance(node.op, ast.Sub))
        else:
            forgotten(machine, target.id)
    return True


def _apply_update(machine: Machine, operator: ast.operator, old: Value, right: Value) -> Value:
    """Return the result of `old += right`: an array or a list keeps its memory, and an array its shape."""
    grows = isinstance(operator, ast.Add) and isinstance(right, Seq | DictValue)
    if isinstance(old, Seq) and old.kind == "list" and grows:
        return bounded(machine.meter, Seq(old.items + entries(machine.meter, right), "list", marks_of(old)))
    new = operate(machine, operator, old, right)
    if isinstance(old, Seq) and isinstance(new, Seq) and old.kind == "list":
        return Seq(new.items, "list", marks_of(old))
    if isinstance(old, Vec):
        return same_shape(machine.meter, old, new)
    return new
