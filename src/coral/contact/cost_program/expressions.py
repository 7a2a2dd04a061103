"""Evaluation of expressions for all states of the batch."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from coral.contact.cost_program.arithmetic import binary, dot, elementwise, negative
from coral.contact.cost_program.binding import checked_key, hold, storable
from coral.contact.cost_program.calls import attribute, call
from coral.contact.cost_program.comprehensions import comprehend
from coral.contact.cost_program.limits import Mask
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.merging import merge
from coral.contact.cost_program.scalars import both, invert, no_truth, truth
from coral.contact.cost_program.subscripts import subscript
from coral.contact.cost_program.values import NUMBER, DictValue, Function, Poison, Seq, Value, Vec, bounded, kind

SYMBOLS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}


def evaluate(machine: Machine, node: ast.expr) -> Value:
    """Evaluate an expression.

    Raises:
        CostError: The expression cannot be evaluated.
    """
    machine.meter.step(node.lineno)
    found = EVALUATORS[type(node)](machine, node)
    if machine.meter.trace is not None and isinstance(node, ast.BinOp | ast.Call):
        _watch(machine, node, found)
    return found


def _watch(machine: Machine, node: ast.expr, value: Value) -> None:
    """Record the first expression that is not finite in a state that counts."""
    trace = machine.meter.trace
    if trace is None or trace.lost is not None or not isinstance(value, (*NUMBER, Vec)):
        return
    for item in value.items if isinstance(value, Vec) else (value,):
        if isinstance(item, NUMBER):
            lost = np.logical_not(np.isfinite(item))
            if machine.meter.mask is not None:
                lost = np.logical_and(lost, machine.meter.mask)
            if np.any(lost):
                trace.lost = (node.lineno, ast.unparse(node)[:80])
                return


def _constant(machine: Machine, node: Any) -> Value:
    return cast(Value, node.value)


def _name(machine: Machine, node: Any) -> Value:
    return machine.lookup(node.id)


def _attribute(machine: Machine, node: Any) -> Value:
    base = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    if isinstance(base, DictValue):  # kept for later, it would not see how the dict changes
        raise machine.meter.fault("not_allowed", "a method of a dict is called at once")
    return attribute(machine, base, node.attr)


def _call(machine: Machine, node: Any) -> Value:
    return call(machine, node, evaluate)


def _binary(machine: Machine, node: Any) -> Value:
    chain = []
    while isinstance(node, ast.BinOp):
        chain.append(node)
        node = node.left
    found = evaluate(machine, node)
    for link in reversed(chain):
        right = evaluate(machine, link.right)
        machine.meter.step(link.lineno)
        found = operate(machine, link.op, found, right)
        if machine.meter.trace is not None:
            _watch(machine, link, found)
    return found


def operate(machine: Machine, operator: ast.operator, left: Value, right: Value) -> Value:
    """Apply a Python operator to two values.

    Raises:
        CostError: The operator does not apply to these values.
    """
    if isinstance(operator, ast.MatMult):
        if not isinstance(left, Vec) and not isinstance(right, Vec):
            raise machine.meter.fault("wrong_type", f"`@` does not apply to {kind(left)} and {kind(right)}; use np.dot")
        return dot(machine.meter, left, right)
    return binary(machine.meter, SYMBOLS[type(operator)], left, right)


def _unary(machine: Machine, node: Any) -> Value:
    value = evaluate(machine, node.operand)
    machine.meter.line = node.lineno
    if isinstance(node.op, ast.Not):
        return invert(machine.meter, value)
    if isinstance(node.op, ast.USub):
        return negative(machine.meter, value)
    if isinstance(value, Seq):
        raise machine.meter.fault("wrong_type", f"`+` does not apply to {kind(value)}; use np.array")
    return elementwise(machine.meter, lambda x: no_truth(machine.meter, x), value)


def _bool(machine: Machine, node: Any) -> Value:
    """Evaluate `and` or `or`: as in Python, the deciding value, per state."""
    found = evaluate(machine, node.values[0])
    for other in node.values[1:]:
        met = truth(machine.meter, found)
        if isinstance(met, bool):
            if met == isinstance(node.op, ast.Or):
                return found
            found = evaluate(machine, other)
            continue
        go_on = met if isinstance(node.op, ast.And) else ~met
        right = _evaluate_under(machine, go_on, other)
        found = _join_values(machine, go_on, right, found)
    return found


def _join_values(machine: Machine, condition: Mask, a: Value, b: Value) -> Value:
    found = merge(machine.meter, condition, a, b)
    if isinstance(found, Poison):
        raise machine.meter.fault("mixed", f"both sides must be of one kind: {found.reason}")
    return found


def _evaluate_under(machine: Machine, condition: Mask, node: ast.expr) -> Value:
    """Evaluate an expression that counts only where a condition holds."""
    before = machine.meter.mask
    machine.meter.mask = machine.narrowed(condition, before)
    found = evaluate(machine, node)
    machine.meter.mask = before
    return found


def _if(machine: Machine, node: Any) -> Value:
    met = truth(machine.meter, evaluate(machine, node.test))
    if isinstance(met, bool):
        return evaluate(machine, node.body if met else node.orelse)
    return _join_values(
        machine, met, _evaluate_under(machine, met, node.body), _evaluate_under(machine, ~met, node.orelse)
    )


def _compare(machine: Machine, node: Any) -> Value:
    left = evaluate(machine, node.left)
    found: Value = True
    for operator, right_node in zip(node.ops, node.comparators, strict=True):
        right = evaluate(machine, right_node)
        machine.meter.line = node.lineno
        step = binary(machine.meter, SYMBOLS[type(operator)], left, right)
        if len(node.ops) == 1:
            return step
        found = both(machine.meter, truth(machine.meter, found), truth(machine.meter, step))
        left = right
    return found


def _items(machine: Machine, nodes: list[ast.expr]) -> tuple[Value, ...]:
    return tuple(storable(machine, evaluate(machine, node)) for node in nodes)


def _list(machine: Machine, node: Any) -> Value:
    return bounded(machine.meter, Seq(_items(machine, node.elts)))


def _tuple(machine: Machine, node: Any) -> Value:
    return bounded(machine.meter, Seq(_items(machine, node.elts), "tuple"))


def _dict(machine: Machine, node: Any) -> Value:
    items: dict[Value, Value] = {}
    for key_node, value_node in zip(node.keys, node.values, strict=True):
        if key_node is None:
            raise machine.meter.fault("not_allowed", "a dict has no ** entries; write them one by one")
        key = checked_key(machine, evaluate(machine, key_node))
        items[key] = hold(machine, evaluate(machine, value_node))
    return bounded(machine.meter, DictValue(items))


def _lambda(machine: Machine, node: Any) -> Value:
    return make_function(machine, "lambda", node.args, node.body, frozenset())


def make_function(
    machine: Machine, name: str, arguments: ast.arguments, body: list[ast.stmt] | ast.expr, names: frozenset[str]
) -> Function:
    """Make the function of a `def` or `lambda`; its defaults are evaluated now."""
    wanted = [argument.arg for argument in arguments.args]
    given = wanted[len(wanted) - len(arguments.defaults) :]
    defaults = {
        name: hold(machine, evaluate(machine, default)) for name, default in zip(given, arguments.defaults, strict=True)
    }
    return Function(name, wanted, body, defaults, machine.frame, names | frozenset(wanted))


def _comprehension(machine: Machine, node: Any) -> Value:
    return comprehend(machine, node, evaluate)


def _subscript(machine: Machine, node: Any) -> Value:
    base = evaluate(machine, node.value)
    return subscript(machine, base, node.slice, evaluate)


def _misplaced(machine: Machine, node: Any) -> Value:
    raise machine.meter.fault("not_allowed", "a slice is an index of a list or array")


EVALUATORS: dict[type[ast.AST], Callable[[Machine, Any], Value]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.Call: _call,
    ast.BinOp: _binary,
    ast.UnaryOp: _unary,
    ast.BoolOp: _bool,
    ast.IfExp: _if,
    ast.Compare: _compare,
    ast.List: _list,
    ast.Tuple: _tuple,
    ast.Dict: _dict,
    ast.Lambda: _lambda,
    ast.ListComp: _comprehension,
    ast.GeneratorExp: _comprehension,
    ast.Subscript: _subscript,
    ast.Slice: _misplaced,
}
