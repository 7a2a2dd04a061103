"""Running statements: both branches of an `if` that depends on the state are run, and joined state by state."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

import numpy as np

from coral.contact.cost_program.arithmetic import truth
from coral.contact.cost_program.calls import CHANGERS, leave
from coral.contact.cost_program.expressions import evaluate, make_function, operate, storable, unpack
from coral.contact.cost_program.in_place import check_unshared, is_inside
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.library import CONSTANTS, IMPORTABLE, MODULES
from coral.contact.cost_program.machine import Loop, Machine
from coral.contact.cost_program.replacing import replaced, same_shape
from coral.contact.cost_program.sharing import marks_of
from coral.contact.cost_program.subscripts import subscript
from coral.contact.cost_program.sums import LEDGER, added, evaluate_sum, forgotten
from coral.contact.cost_program.values import DictValue, Module, Seq, Value, Vec, bounded, kind


def run_block(machine: Machine, body: list[ast.stmt]) -> bool:
    """Run statements; whether some state reaches their end.

    Raises:
        CostError: One of them cannot be run.
    """
    for statement in body:
        machine.meter.step(statement.lineno)
        if not EXECUTORS[type(statement)](machine, statement):
            return False
    return True


def _expression(machine: Machine, node: Any) -> bool:
    value = node.value
    if isinstance(value, ast.Constant):
        return True
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Attribute) and value.func.attr in CHANGERS:
        _change(machine, value, value.func)
        return True
    evaluate(machine, value)
    return True


def _change(machine: Machine, node: ast.Call, function: ast.Attribute) -> None:
    """`list.append(x)`, `list.extend(xs)`, `dict.update(d)`."""
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
    """The variable whose value, or whose entry, a statement changes in place.

    Raises:
        CostError: It is no variable of the program, or cannot be changed from here.
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
    """Let a variable, or an entry of one, hold the changed container."""
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


def _set(machine: Machine, target: ast.expr, value: Value) -> None:
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


def _assign(machine: Machine, node: Any) -> bool:
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
        _set(machine, target, value)
    return True


def _augment(machine: Machine, node: Any) -> bool:
    target = node.target
    if isinstance(target, ast.Subscript):
        name = _root(machine, target)
        holder = evaluate(machine, target.value)
        old = subscript(machine, holder, target.slice, evaluate)
        machine.pending.append(holder)
        right = evaluate(machine, node.value)
        machine.pending.pop()
        machine.meter.line = node.lineno
        new = _updated(machine, node.op, old, right)
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
    if isinstance(old, Vec | Seq):
        machine.pending.append(old)
    right = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    if isinstance(old, Vec | Seq):
        machine.pending.pop()
        if isinstance(old, Vec) or old.kind == "list":
            check_unshared(machine, old, target.id)
    machine.frame.variables[target.id] = _updated(machine, node.op, old, right)
    if machine.frame.entry and target.id in machine.sums:
        if isinstance(node.op, ast.Add | ast.Sub):
            added(machine, target.id, node.value, right, isinstance(node.op, ast.Sub))
        else:
            forgotten(machine, target.id)
    return True


def _updated(machine: Machine, operator: ast.operator, old: Value, right: Value) -> Value:
    """What `old += right` leaves: an array or a list keeps its memory, and an array its shape."""
    grows = isinstance(operator, ast.Add) and isinstance(right, Seq | DictValue)
    if isinstance(old, Seq) and old.kind == "list" and grows:
        return bounded(machine.meter, Seq(old.items + entries(machine.meter, right), "list", marks_of(old)))
    new = operate(machine, operator, old, right)
    if isinstance(old, Seq) and isinstance(new, Seq) and old.kind == "list":
        return Seq(new.items, "list", marks_of(old))
    if isinstance(old, Vec):
        return same_shape(machine.meter, old, new)
    return new


def _return(machine: Machine, node: Any) -> bool:
    if node.value is None:
        leave(machine, None, None)
    elif machine.frame.entry:
        value, ledger = evaluate_sum(machine, node.value, "")
        leave(machine, value, ledger)
    else:
        leave(machine, storable(machine, evaluate(machine, node.value)), None)
    return False


def _if(machine: Machine, node: Any) -> bool:
    met = truth(machine.meter, evaluate(machine, node.test))
    if isinstance(met, bool):
        return run_block(machine, node.body if met else node.orelse)
    before, outer, exited = machine.snapshot(), machine.meter.mask, machine.exited
    machine.meter.mask = machine.narrowed(met, outer)
    then_falls = run_block(machine, node.body)
    then_mask, then = machine.meter.mask, machine.snapshot()
    machine.restore(before)
    machine.meter.mask = machine.narrowed(~met, outer)
    else_falls = run_block(machine, node.orelse)
    if then_falls and else_falls:
        machine.join(met, then)
        if machine.exited == exited:
            machine.meter.mask = outer
        else:
            machine.meter.mask = np.logical_or(then_mask, machine.meter.mask)
        return True
    if then_falls:
        machine.restore(then)
        machine.meter.mask = then_mask
    return then_falls or else_falls


def _for(machine: Machine, node: Any) -> bool:
    source = evaluate(machine, node.iter)
    items = entries(machine.meter, source)
    if len(items) > machine.meter.cfg.loop:
        raise machine.meter.fault("steps", f"a loop has at most {machine.meter.cfg.loop} turns")
    outer, exits, loop, falls = machine.meter.mask, len(machine.frame.exits), Loop((source,)), True
    machine.loops.append(loop)
    machine.running.append(loop)
    for turn, item in enumerate(items):
        machine.meter.step(node.lineno)
        loop.continues, loop.turn = [], turn
        _set(machine, node.target, item)
        falls = run_block(machine, node.body)
        falls = machine.collect(loop.continues, falls)
        if not falls:
            break
    machine.loops.pop()
    machine.running.pop()
    falls = machine.collect(loop.breaks, falls)
    if falls and len(machine.frame.exits) == exits:
        machine.meter.mask = outer
    return falls


def _break(machine: Machine, node: Any) -> bool:
    machine.exited += 1
    machine.loops[-1].breaks.append((machine.meter.mask, machine.snapshot()))
    return False


def _continue(machine: Machine, node: Any) -> bool:
    machine.exited += 1
    machine.loops[-1].continues.append((machine.meter.mask, machine.snapshot()))
    return False


def _pass(machine: Machine, node: Any) -> bool:
    return True


def _define(machine: Machine, node: Any) -> bool:
    machine.frame.variables[node.name] = make_function(
        machine, node.name, node.args, node.body, machine.own_names[id(node)]
    )
    return True


def own_names(body: list[ast.stmt]) -> frozenset[str]:
    """Names that a function sets, not counting those of functions and comprehensions inside it."""
    found: set[str] = set()
    pending: list[ast.AST] = list(body)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
            continue
        if isinstance(node, ast.Lambda | ast.ListComp | ast.DictComp | ast.GeneratorExp):
            continue
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        if isinstance(node, ast.alias):
            found.add(node.asname or node.name)
        pending.extend(ast.iter_child_nodes(node))
    return frozenset(found)


def _import(machine: Machine, node: Any) -> bool:
    for alias in node.names:
        machine.frame.variables[alias.asname or alias.name] = Module(IMPORTABLE[alias.name])
    return True


def _import_from(machine: Machine, node: Any) -> bool:
    if node.module in ("typing", "__future__"):
        return True
    module = IMPORTABLE[node.module]
    for alias in node.names:
        table = MODULES.get(module, {})
        found: Value = CONSTANTS.get(alias.name, table.get(alias.name))
        if found is None:
            raise machine.meter.fault("unknown_name", f"{node.module} has no {alias.name!r} here")
        machine.frame.variables[alias.asname or alias.name] = found
    return True


EXECUTORS: dict[type[ast.AST], Callable[[Machine, Any], bool]] = {
    ast.Expr: _expression,
    ast.Assign: _assign,
    ast.AnnAssign: _assign,
    ast.AugAssign: _augment,
    ast.Return: _return,
    ast.If: _if,
    ast.For: _for,
    ast.Break: _break,
    ast.Continue: _continue,
    ast.Pass: _pass,
    ast.FunctionDef: _define,
    ast.Import: _import,
    ast.ImportFrom: _import_from,
}
