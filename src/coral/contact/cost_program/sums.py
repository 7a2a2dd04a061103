"""The addends of a scalar cost, so that `cost += ...` can be reported and plotted term by term.

Besides the cost itself, which is computed exactly as in Python, a ledger records what each statement added. The sum of
the terms equals the cost up to rounding, and exactly if each statement runs once.
"""

from __future__ import annotations

import ast

from coral.contact.cost_program.arithmetic import binary, negative
from coral.contact.cost_program.arrays import to_float, to_plain
from coral.contact.cost_program.expressions import evaluate, operate
from coral.contact.cost_program.library import BUILTINS
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.merging import filled
from coral.contact.cost_program.scalars import number
from coral.contact.cost_program.values import NUMBER, Builtin, DictValue, Value

LEDGER = "terms of "
"""Prefix of the hidden variable that holds a ledger; not a name that a program could write."""


def summed_variables(entry: ast.FunctionDef) -> frozenset[str]:
    """Find the variables whose addends become terms: those that are returned, and those they are summed from."""
    augmented = {
        node.target.id
        for node in ast.walk(entry)
        if isinstance(node, ast.AugAssign)
        and isinstance(node.op, ast.Add | ast.Sub)
        and isinstance(node.target, ast.Name)
    }
    found: set[str] = set()
    for node in ast.walk(entry):
        if isinstance(node, ast.Return) and node.value is not None:
            parts = addends(node.value)
            found |= {
                part.id for part in parts if isinstance(part, ast.Name) and (len(parts) == 1 or part.id in augmented)
            }
    while True:
        more = {
            part.id
            for node in ast.walk(entry)
            if isinstance(node, ast.Assign)
            and len(node.targets) == 1
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id in found
            for part in addends(node.value)
            if isinstance(part, ast.Name) and part.id in augmented
        }
        if more <= found:
            return frozenset(found)
        found |= more


def addends(node: ast.expr) -> list[ast.expr]:
    """Split a sum into its addends, looking through signs and float(...)."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        parts: list[ast.expr] = []
        rest: ast.expr = node
        while isinstance(rest, ast.BinOp) and isinstance(rest.op, ast.Add | ast.Sub):
            parts.append(rest.right)
            rest = rest.left
        return [*addends(rest), *reversed(parts)]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return addends(node.operand)
    inner = _float_argument(node)
    return addends(inner) if inner is not None else [node]


def _float_argument(node: ast.expr) -> ast.expr | None:
    """Return the argument of float(x) or np.float64(x)."""
    if isinstance(node, ast.Call) and len(node.args) == 1 and not node.keywords:
        name = (
            node.func.id
            if isinstance(node.func, ast.Name)
            else (node.func.attr if isinstance(node.func, ast.Attribute) else "")
        )
        if name in ("float", "float64") and not isinstance(node.args[0], ast.Starred):
            return node.args[0]
    return None


def evaluate_sum(machine: Machine, node: ast.expr, variable: str) -> tuple[Value, DictValue | None]:
    """Evaluate a sum together with its addends by name; the addends are None if the value is not a number.

    Args:
        machine: The evaluation.
        node: The expression.
        variable: Variable that it is assigned to, or "" in a return.
    """
    whole = len(addends(node)) == 1
    return _sum(machine, node, variable, whole)


def _sum(machine: Machine, node: ast.expr, variable: str, whole: bool) -> tuple[Value, DictValue | None]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        chain: list[ast.BinOp] = []
        rest: ast.expr = node
        while isinstance(rest, ast.BinOp) and isinstance(rest.op, ast.Add | ast.Sub):
            chain.append(rest)
            rest = rest.left
        value, ledger = _sum(machine, rest, variable, whole)
        for link in reversed(chain):
            machine.pending.append(value)
            right, more = _leaf(machine, link.right, variable, False)
            machine.pending.pop()
            machine.meter.step(link.lineno)
            value = operate(machine, link.op, value, right)
            ledger = _join_ledgers(machine, ledger, more, isinstance(link.op, ast.Sub))
        return value, ledger if isinstance(value, NUMBER) else None
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value, ledger = _sum(machine, node.operand, variable, whole)
        return negative(machine.meter, value), _join_ledgers(machine, DictValue({}), ledger, True)
    inner = _float_argument(node)
    if inner is not None and isinstance(node, ast.Call) and _plain_float(machine, node):
        value, ledger = _sum(machine, inner, variable, whole)
        return (to_plain if isinstance(node.func, ast.Name) else to_float)(machine.meter, value), ledger
    return _leaf(machine, node, variable, whole)


def _plain_float(machine: Machine, node: ast.Call) -> bool:
    if not isinstance(node.func, ast.Name):
        return True
    found = machine.lookup("float")
    return isinstance(found, Builtin) and found.name == "float"


def _leaf(machine: Machine, node: ast.expr, variable: str, whole: bool) -> tuple[Value, DictValue | None]:
    value = evaluate(machine, node)
    if isinstance(node, ast.Name) and node.id in machine.sums:
        kept = machine.frame.variables.get(LEDGER + node.id)
        if isinstance(kept, DictValue):
            return value, kept
    table = _summed_dict(machine, node)
    if table is not None:
        return value, table
    return value, ledger_of(machine, node, value, variable, whole)


def ledger_of(machine: Machine, node: ast.expr, value: Value, variable: str, whole: bool) -> DictValue | None:
    """Make the ledger of a single addend; a constant zero adds nothing."""
    if not isinstance(value, NUMBER):
        return None
    if isinstance(value, int | float) and value == 0:
        return DictValue({})
    return DictValue({machine.terms.of(node, whole, variable): number(machine.meter, value)})


def _summed_dict(machine: Machine, node: ast.expr) -> DictValue | None:
    """Return the dict of `sum(terms.values())`, whose entries already have names."""
    if not (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "sum"
        and machine.lookup("sum") is BUILTINS["sum"]
        and len(node.args) == 1
        and not node.keywords
        and isinstance(node.args[0], ast.Call)
        and not node.args[0].args
    ):
        return None
    inner = node.args[0].func
    if not (isinstance(inner, ast.Attribute) and inner.attr == "values" and isinstance(inner.value, ast.Name)):
        return None
    table = machine.lookup(inner.value.id)
    if isinstance(table, DictValue) and all(isinstance(key, str) for key in table.items):
        return DictValue(dict(table.items))
    return None


def _join_ledgers(machine: Machine, ledger: DictValue | None, more: DictValue | None, minus: bool) -> DictValue | None:
    if ledger is None or more is None:
        return None
    items = dict(ledger.items)
    for name, value in more.items.items():
        amount = filled(machine.meter, value, 0.0)
        amount = negative(machine.meter, amount) if minus else amount
        if name in items:
            amount = binary(machine.meter, "+", filled(machine.meter, items[name], 0.0), amount)
        items[name] = amount
    return DictValue(items)


def added(machine: Machine, variable: str, node: ast.expr, value: Value, minus: bool) -> None:
    """Record the addends of `variable += node`."""
    before = machine.frame.variables.get(LEDGER + variable)
    more = ledger_of(machine, node, value, variable, True)
    joined = _join_ledgers(machine, before if isinstance(before, DictValue) else None, more, minus)
    machine.frame.variables[LEDGER + variable] = joined


def forgotten(machine: Machine, variable: str) -> None:
    """Forget the addends of a variable that changed other than by adding: its value becomes a single term."""
    machine.frame.variables[LEDGER + variable] = None
