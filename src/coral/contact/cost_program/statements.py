"""Running statements: both branches of an `if` that depends on the state are run, then merged state by state."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

import numpy as np

from coral.contact.cost_program.assigning import assign, augment, change
from coral.contact.cost_program.binding import storable
from coral.contact.cost_program.calls import CHANGERS, leave
from coral.contact.cost_program.expressions import evaluate, make_function
from coral.contact.cost_program.library import CONSTANTS, IMPORTABLE, MODULES
from coral.contact.cost_program.loops import leave_loop, next_turn, run_for
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.scalars import truth
from coral.contact.cost_program.sums import evaluate_sum
from coral.contact.cost_program.values import Module, Value

CHANGED_BY = ("append", "extend", "update", "pop", "setdefault", "insert", "remove", "clear", "sort", "reverse", "fill")
"""Methods that change a list, a dict or an array."""


def run_block(machine: Machine, body: list[ast.stmt]) -> bool:
    """Run statements; return whether some state reaches their end.

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
        change(machine, value, value.func)
        return True
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and _is_print(machine, value):
        return True
    evaluate(machine, value)
    return True


def _is_print(machine: Machine, node: ast.Call) -> bool:
    """Check for Python's print, which is skipped together with its arguments.

    Raises:
        CostError: An argument could change something.
    """
    if not isinstance(node.func, ast.Name) or node.func.id != "print" or machine.owner("print") is not None:
        return False
    for part in ast.walk(node):
        called = part.func if isinstance(part, ast.Call) and part is not node else None
        own = isinstance(called, ast.Name) and machine.owner(called.id) is not None
        method = isinstance(called, ast.Attribute) and called.attr in CHANGED_BY
        if isinstance(part, ast.Lambda) or own or method:
            raise machine.meter.fault(
                "not_allowed",
                "print is ignored, so it may call neither functions of the program nor what changes a list",
            )
    return True


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


def _pass(machine: Machine, node: Any) -> bool:
    return True


def _define(machine: Machine, node: Any) -> bool:
    machine.frame.variables[node.name] = make_function(
        machine, node.name, node.args, node.body, machine.own_names[id(node)]
    )
    return True


def own_names(body: list[ast.stmt]) -> frozenset[str]:
    """Return the names that a function sets, excluding functions and comprehensions inside it."""
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
    for alias in node.names:
        module = IMPORTABLE[node.module]
        found: Value = CONSTANTS.get(module, {}).get(alias.name, MODULES.get(module, {}).get(alias.name))
        if found is None:
            raise machine.meter.fault("unknown_name", f"{node.module} has no {alias.name!r} here")
        machine.frame.variables[alias.asname or alias.name] = found
    return True


EXECUTORS: dict[type[ast.AST], Callable[[Machine, Any], bool]] = {
    ast.Expr: _expression,
    ast.Assign: assign,
    ast.AnnAssign: assign,
    ast.AugAssign: augment,
    ast.Return: _return,
    ast.If: _if,
    ast.For: run_for,
    ast.Break: leave_loop,
    ast.Continue: next_turn,
    ast.Pass: _pass,
    ast.FunctionDef: _define,
    ast.Import: _import,
    ast.ImportFrom: _import_from,
}
