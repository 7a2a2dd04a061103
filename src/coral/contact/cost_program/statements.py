"""Running statements: both branches of an `if` that depends on the state are run, then merged state by state."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

import numpy as np

from coral.contact.cost_program.arithmetic import truth
from coral.contact.cost_program.calls import leave
from coral.contact.cost_program.expressions import (
    SYMBOLS,
    checked_key,
    evaluate,
    make_function,
    operate,
    subscript,
    unpack,
)
from coral.contact.cost_program.library import MODULE_NAMES
from coral.contact.cost_program.limits import MOST_TURNS
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.values import Module, Value, bounded, entries, is_number, kind


def run_block(machine: Machine, body: list[ast.stmt]) -> bool:
    """Run statements; return whether some state reaches their end."""
    for statement in body:
        machine.meter.step(statement.lineno)
        if not EXECUTORS[type(statement)](machine, statement):
            return False
    return True


def _expression(machine: Machine, node: Any) -> bool:
    evaluate(machine, node.value)
    return True


def _assign(machine: Machine, node: Any) -> bool:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if node.value is not None:
        value = evaluate(machine, node.value)
        for target in targets:
            _assign_to(machine, target, value)
    return True


def _assign_to(machine: Machine, target: ast.expr, value: Value) -> None:
    if not isinstance(target, ast.Subscript):
        unpack(machine, target, value)
        return
    fault, name = machine.meter.fault, target.value
    base = evaluate(machine, name)
    machine.meter.line = target.lineno
    if not isinstance(base, dict):
        raise fault("not_allowed", f"entries of {kind(base)} cannot be set; make a new one, as with np.array([...])")
    if not isinstance(name, ast.Name) or name.id not in machine.frame.variables:
        raise fault("not_allowed", "only the entries of a function's own dicts can be set, under their own name")
    held = [one for frame in machine.stack for one in frame.variables.values()]
    machine.meter.spend(len(held))
    if sum(_holds(machine, one, base) for one in held) > 1:
        raise fault("shared", f"{name.id!r} would change under another name, too; write the dict a second time")
    key = checked_key(machine, evaluate(machine, target.slice))
    machine.frame.variables[name.id] = bounded(machine.meter, {**base, key: value})


def _holds(machine: Machine, value: Value, held: Value) -> bool:
    """Check whether a value is a dict, or a container that holds it."""
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    machine.meter.spend(len(items))
    return value is held or any(_holds(machine, item, held) for item in items)


def _augment(machine: Machine, node: Any) -> bool:
    """Run `x += value`, of a number or of the entry of a dict that is one."""
    target, fault = node.target, machine.meter.fault
    if isinstance(target, ast.Name):
        if target.id not in machine.frame.variables:
            raise fault("unset", f"{target.id!r} has no value before it is changed; begin with {target.id} = 0.0")
        old = machine.lookup(target.id)
    elif isinstance(target, ast.Subscript):
        old = subscript(machine, evaluate(machine, target.value), target.slice)
    else:
        raise fault("not_allowed", "the state cannot be changed; use a variable of your own")
    right = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    if not is_number(old):
        name, symbol = ast.unparse(target), SYMBOLS.get(type(node.op), "@")
        raise fault("shared", f"{kind(old)} would change under all its names; write {name} = {name} {symbol} ...")
    _assign_to(machine, target, operate(machine, node.op, old, right))
    return True


def _return(machine: Machine, node: Any) -> bool:
    leave(machine, None if node.value is None else evaluate(machine, node.value))
    return False


def _if(machine: Machine, node: Any) -> bool:
    met = truth(machine.meter, evaluate(machine, node.test))
    if isinstance(met, bool):
        return run_block(machine, node.body if met else node.orelse)
    before, outer, exits = machine.snapshot(), machine.meter.mask, len(machine.frame.exits)
    machine.conditions += 1
    machine.meter.mask = machine.narrowed(met, outer)
    then_falls = run_block(machine, node.body)
    then_mask, then = machine.meter.mask, machine.snapshot()
    machine.restore(before)
    machine.meter.mask = machine.narrowed(~met, outer)
    else_falls = run_block(machine, node.orelse)
    machine.conditions -= 1
    if then_falls and else_falls:
        machine.join(met, then)
        if len(machine.frame.exits) == exits:
            machine.meter.mask = outer
        else:
            machine.meter.mask = np.logical_or(then_mask, machine.meter.mask)
        return True
    if then_falls:
        machine.restore(then)
        machine.meter.mask = then_mask
    return then_falls or else_falls


def _for(machine: Machine, node: Any) -> bool:
    items = entries(machine.meter, evaluate(machine, node.iter))
    if len(items) > MOST_TURNS:
        raise machine.meter.fault("steps", f"a loop has at most {MOST_TURNS} turns")
    outer, machine.conditions, falls = machine.conditions, 0, True
    for item in items:
        machine.meter.step(node.lineno)
        _assign_to(machine, node.target, item)
        falls = run_block(machine, node.body)
        left, machine.left = machine.left, ""
        if left == "break" or not (falls or left):
            falls = bool(left)
            break
        falls = True
    machine.conditions = outer
    return falls


def _leave_turn(machine: Machine, node: Any) -> bool:
    """Run `break` or `continue`."""
    machine.left = "break" if isinstance(node, ast.Break) else "continue"
    if machine.conditions:
        raise machine.meter.fault(
            "not_fixed", f"`{machine.left}` depends on the state; write an `if` around the rest of the loop instead"
        )
    return False


def _define(machine: Machine, node: Any) -> bool:
    machine.frame.variables[node.name] = make_function(
        machine, node.name, node.args, node.body, machine.own_names[id(node)]
    )
    return True


def _import(machine: Machine, node: Any) -> bool:
    for alias in node.names:
        machine.frame.variables[alias.asname or alias.name] = Module(MODULE_NAMES[alias.name])
    return True


EXECUTORS: dict[type[ast.AST], Callable[[Machine, Any], bool]] = {
    ast.Expr: _expression,
    ast.Assign: _assign,
    ast.AnnAssign: _assign,
    ast.AugAssign: _augment,
    ast.Return: _return,
    ast.If: _if,
    ast.For: _for,
    ast.Break: _leave_turn,
    ast.Continue: _leave_turn,
    ast.Pass: lambda machine, node: True,
    ast.FunctionDef: _define,
    ast.Import: _import,
}
