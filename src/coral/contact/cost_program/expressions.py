"""Evaluation of expressions for all states of the batch, and the names that their values are bound to."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

import numpy as np

from coral.contact.cost_program.arithmetic import apply, binary, both, dot, no_truth, truth
from coral.contact.cost_program.calls import attribute, call
from coral.contact.cost_program.limits import Mask
from coral.contact.cost_program.machine import Machine, merge
from coral.contact.cost_program.values import (
    Function,
    Poison,
    Scope,
    Value,
    bounded,
    entries,
    is_number,
    is_vector,
    kind,
)

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
    """Evaluate an expression."""
    machine.meter.step(node.lineno)
    found = EVALUATORS[type(node)](machine, node)
    if machine.meter.watched and isinstance(node, ast.BinOp | ast.Call):
        _watch(machine, node, found)
    return found


def _watch(machine: Machine, node: ast.expr, value: Value) -> None:
    """Record the first expression that is not finite in a state that counts."""
    meter = machine.meter
    if meter.lost is None and (is_number(value) or is_vector(value)):
        lost = np.logical_not(np.isfinite(value))
        if np.any(lost if meter.mask is None else np.logical_and(lost, meter.mask)):
            meter.lost = (node.lineno, ast.unparse(node)[:80])


def _attribute(machine: Machine, node: Any) -> Value:
    base = evaluate(machine, node.value)
    machine.meter.line = node.lineno
    if isinstance(base, dict):  # kept for later, it would not see how the dict changes
        raise machine.meter.fault("not_allowed", "a method of a dict is called at once")
    return attribute(machine, base, node.attr)


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
        if machine.meter.watched:
            _watch(machine, link, found)
    return found


def operate(machine: Machine, operator: ast.operator, left: Value, right: Value) -> Value:
    """Apply a Python operator to two values."""
    if isinstance(operator, ast.MatMult):
        if not is_vector(left) and not is_vector(right):
            raise machine.meter.fault("wrong_type", f"`@` does not apply to {kind(left)} and {kind(right)}; use np.dot")
        return dot(machine.meter, left, right)
    return binary(machine.meter, SYMBOLS[type(operator)], left, right)


def _unary(machine: Machine, node: Any) -> Value:
    value = evaluate(machine, node.operand)
    machine.meter.line = node.lineno
    if isinstance(node.op, ast.Not):
        met = truth(machine.meter, value)
        return not met if isinstance(met, bool) else np.logical_not(met)
    if isinstance(value, list | tuple):
        symbol = "-" if isinstance(node.op, ast.USub) else "+"
        raise machine.meter.fault("wrong_type", f"`{symbol}` does not apply to {kind(value)}; use np.array")
    found = no_truth(machine.meter, value)
    if not isinstance(node.op, ast.USub):
        return found
    return apply(machine.meter, np.negative, found) if isinstance(found, np.ndarray) else -found


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


def _dict(machine: Machine, node: Any) -> Value:
    items: dict[Value, Value] = {}
    for key_node, value_node in zip(node.keys, node.values, strict=True):
        if key_node is None:
            raise machine.meter.fault("not_allowed", "a dict has no ** entries; write them one by one")
        items[checked_key(machine, evaluate(machine, key_node))] = evaluate(machine, value_node)
    return bounded(machine.meter, items)


def checked_key(machine: Machine, key: Value) -> Value:
    """Return the key of a dict, checked."""
    if isinstance(key, str | int) and not isinstance(key, bool):
        return key
    raise machine.meter.fault("not_fixed", f"the keys of a dict are constant texts or whole numbers, not {kind(key)}")


def unpack(machine: Machine, target: ast.expr, value: Value) -> None:
    """Bind the name, or the names of a tuple, of an assignment or loop."""
    if isinstance(target, ast.Name):
        machine.frame.variables[target.id] = value
        return
    if not isinstance(target, ast.Tuple | ast.List):
        raise machine.meter.fault("not_allowed", "only variables and entries of dicts can be set; the state cannot")
    items = entries(machine.meter, value)
    if len(items) != len(target.elts):
        raise machine.meter.fault("wrong_size", f"{len(target.elts)} names cannot take {len(items)} values")
    for part, item in zip(target.elts, items, strict=True):
        unpack(machine, part, item)


def make_function(
    machine: Machine, name: str, arguments: ast.arguments, body: list[ast.stmt] | ast.expr, names: frozenset[str]
) -> Function:
    """Make the function of a `def` or `lambda`; its defaults are evaluated now."""
    wanted = [argument.arg for argument in arguments.args]
    given = wanted[len(wanted) - len(arguments.defaults) :]
    defaults = {name: evaluate(machine, default) for name, default in zip(given, arguments.defaults, strict=True)}
    return Function(name, wanted, body, defaults, machine.frame, names | frozenset(wanted))


def _comprehension(machine: Machine, node: Any) -> Value:
    names = frozenset(
        item.id for generator in node.generators for item in ast.walk(generator.target) if isinstance(item, ast.Name)
    )
    found: list[Value] = []
    outermost = evaluate(machine, node.generators[0].iter)  # in the enclosing scope, as in Python
    machine.stack.append(Scope(machine.frame, names))

    def is_met(test: ast.expr) -> bool:
        met = truth(machine.meter, evaluate(machine, test))
        if isinstance(met, bool):
            return met
        raise machine.meter.fault(
            "not_fixed", "this filter depends on the state; write `x if condition else 0.0` in place of it"
        )

    def generate(level: int) -> None:
        if level == len(node.generators):
            found.append(evaluate(machine, node.elt))
            return
        generator = node.generators[level]
        for item in entries(machine.meter, evaluate(machine, generator.iter) if level else outermost):
            unpack(machine, generator.target, item)
            if all(map(is_met, generator.ifs)):
                generate(level + 1)

    generate(0)
    machine.stack.pop()
    return bounded(machine.meter, found)


def subscript(machine: Machine, base: Value, node: ast.expr) -> Value:
    """Evaluate `base[node]`: `v[0]`, `v[:2]`, `xs[-1]`, `weights["reach"]`."""
    fault = machine.meter.fault
    if isinstance(base, dict):
        key = checked_key(machine, evaluate(machine, node))
        if key not in base:
            known = ", ".join(ascii(name) for name in base)
            raise fault("wrong_size", f"the dict has no {key!r}; it has {known or 'nothing'}")
        return machine.usable(base[key], str(key))
    if not isinstance(base, list | tuple) and not is_vector(base):
        raise fault("wrong_type", f"{kind(base)} has no numbered entries")
    if isinstance(node, ast.Slice):
        ends = [_index(machine, evaluate(machine, end)) if end else None for end in (node.lower, node.upper, node.step)]
        if ends[2] == 0:
            raise fault("wrong_size", "the step of a slice is not 0")
        found = base[slice(*ends)]
        if is_vector(found) and not len(found):
            raise fault("wrong_size", "an array has at least one entry")
        machine.meter.spend(len(found))
        return found
    if isinstance(node, ast.Tuple):
        raise fault("wrong_type", f"{kind(base)} has one axis")
    where = _index(machine, evaluate(machine, node))
    if not -len(base) <= where < len(base):
        raise fault("wrong_size", f"{kind(base)} has no entry {where}")
    return machine.usable(base[where], f"[{where}]")


def _index(machine: Machine, value: Value) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise machine.meter.fault(
        "not_fixed",
        f"an index is a constant whole number, not {kind(value)}; to pick by a condition on the state use np.where",
    )


def _misplaced(machine: Machine, node: Any) -> Value:
    raise machine.meter.fault("not_allowed", "a slice is an index of a list or array")


EVALUATORS: dict[type[ast.AST], Callable[[Machine, Any], Value]] = {
    ast.Constant: lambda machine, node: node.value,
    ast.Name: lambda machine, node: machine.lookup(node.id),
    ast.Attribute: _attribute,
    ast.Call: lambda machine, node: call(machine, node, evaluate),
    ast.BinOp: _binary,
    ast.UnaryOp: _unary,
    ast.BoolOp: _bool,
    ast.IfExp: _if,
    ast.Compare: _compare,
    ast.List: lambda machine, node: bounded(machine.meter, [evaluate(machine, item) for item in node.elts]),
    ast.Tuple: lambda machine, node: bounded(machine.meter, tuple(evaluate(machine, item) for item in node.elts)),
    ast.Dict: _dict,
    ast.Lambda: lambda machine, node: make_function(machine, "lambda", node.args, node.body, frozenset()),
    ast.ListComp: _comprehension,
    ast.GeneratorExp: _comprehension,
    ast.Subscript: lambda machine, node: subscript(machine, evaluate(machine, node.value), node.slice),
    ast.Slice: _misplaced,
}
