"""Attributes and calls: the only ways from a value to a function, each a look-up in a table of this package."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable

import numpy as np

from coral.contact.cost_program.arrays import copied, shape, transpose
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.library import CONSTANTS, MODULES, VECTOR_METHODS, instead
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.merging import filled, merge
from coral.contact.cost_program.sharing import marks_of
from coral.contact.cost_program.values import (
    Builtin,
    DictValue,
    Function,
    Module,
    Partial,
    Poison,
    Scope,
    Seq,
    State,
    Value,
    Vec,
    bounded,
    kind,
)
from coral.errors import nearest

Evaluate = Callable[[Machine, ast.expr], Value]
CHANGERS = {"append": Seq, "extend": Seq, "update": DictValue}


def attribute(machine: Machine, base: Value, name: str) -> Value:
    """Evaluate `base.name`.

    Raises:
        CostError: The value has no such attribute.
    """
    if isinstance(base, State):
        return machine.space.read(machine.meter, name)
    if isinstance(base, Module):
        return _member(machine, base, name)
    if isinstance(base, Vec):
        return _of_vector(machine, base, name)
    if name in CHANGERS and isinstance(base, CHANGERS[name]):
        raise machine.meter.fault("not_allowed", f"{name} is a statement of its own")
    if isinstance(base, DictValue) and name in TABLE_METHODS:
        method = TABLE_METHODS[name]
        return Builtin(name, lambda _, args, named: method(machine, base, [*args, *named.values()]), base)
    raise _unknown(machine, base, name, list(TABLE_METHODS) if isinstance(base, DictValue) else [])


def _bound(base: Value, method: Builtin) -> Builtin:
    return Builtin(method.name, lambda meter, args, named: method.call(meter, [base, *args], named), base)


def _unknown(machine: Machine, base: Value, name: str, known: list[str]) -> Exception:
    listed = f"; it has {', '.join(known)}" if known else ""
    return machine.meter.fault("unknown_attribute", f"{kind(base)} has no {name!r}{nearest(name, known)}{listed}")


def _member(machine: Machine, module: Module, name: str) -> Value:
    if module.name == "p":
        if name not in machine.bullet.calls:
            raise machine.meter.fault(
                "unknown_attribute",
                f"p has no {name!r}{nearest(name, machine.bullet.calls)}; it has {', '.join(machine.bullet.calls)}",
            )
        return Builtin(f"p.{name}", lambda meter, args, named: machine.bullet(meter, name, args, named))
    if module.name == "np" and name == "linalg":
        return Module("np.linalg")
    inside = "linalg." if module.name == "np.linalg" else ""
    table = MODULES[module.name.removesuffix(".linalg")]
    if name in CONSTANTS.get(module.name, {}):
        return CONSTANTS[module.name][name]
    if inside + name not in table:
        hint = instead(f"{module.name}.{name}")
        known = [key.removeprefix(inside) for key in table if key.startswith(inside) and ("." in key) == bool(inside)]
        raise machine.meter.fault(
            "unknown_attribute",
            f"{module.name} has no {name!r} here{hint or nearest(name, known)}; it has {', '.join(sorted(known))}",
        )
    return table[inside + name]


def _of_vector(machine: Machine, base: Value, name: str) -> Value:
    sizes = shape(base)
    if name == "T":
        return transpose(machine.meter, base)
    if name in ("shape", "ndim", "size"):
        return Seq(sizes, "tuple") if name == "shape" else len(sizes) if name == "ndim" else math.prod(sizes)
    if name not in VECTOR_METHODS:
        raise _unknown(machine, base, name, sorted([*VECTOR_METHODS, "T", "shape"]))
    return _bound(base, VECTOR_METHODS[name])


def _get(machine: Machine, table: DictValue, args: list[Value]) -> Value:
    if not 1 <= len(args) <= 2 or not isinstance(args[0], str | int):
        raise machine.meter.fault("wrong_call", "get takes a key and a default")
    default = args[1] if len(args) == 2 else None
    found = filled(machine.meter, table.items.get(args[0], default), default)
    if isinstance(found, Poison):
        raise machine.meter.fault("mixed", f"{args[0]!r} cannot be used: {found.reason}")
    return found


def _items(machine: Machine, table: DictValue, args: list[Value]) -> Value:
    return Seq(tuple(Seq((key, value), "tuple") for key, value in table.items.items()), "view", marks_of(table))


def _keys(machine: Machine, table: DictValue, args: list[Value]) -> Value:
    return Seq(tuple(table.items), "view", marks_of(table))


def _values(machine: Machine, table: DictValue, args: list[Value]) -> Value:
    return Seq(tuple(table.items.values()), "values", marks_of(table))


def _copy(machine: Machine, table: DictValue, args: list[Value]) -> Value:
    return copied(machine.meter, table)


TABLE_METHODS: dict[str, Callable[[Machine, DictValue, list[Value]], Value]] = {
    "get": _get,
    "items": _items,
    "keys": _keys,
    "values": _values,
    "copy": _copy,
}


def call(machine: Machine, node: ast.Call, evaluate: Evaluate) -> Value:
    """Evaluate a call.

    Raises:
        CostError: The callee is not a function, or does not accept these arguments.
    """
    if isinstance(node.func, ast.Name) and node.func.id in ("getattr", "hasattr"):
        return _reflect(machine, node, node.func.id, evaluate)
    function = evaluate(machine, node.func)
    waiting = len(machine.pending)
    if isinstance(function, Builtin) and function.bound is not None:
        machine.pending.append(function.bound)
    args: list[Value] = []
    for item in node.args:
        if isinstance(item, ast.Starred):
            more = entries(machine.meter, evaluate(machine, item.value))
        else:
            more = (evaluate(machine, item),)
        args.extend(more)
        machine.pending.extend(more)
    named: dict[str, Value] = {}
    for keyword in node.keywords:
        if keyword.arg is None:
            raise machine.meter.fault("not_allowed", "a cost has no ** in calls; write the keywords one by one")
        named[keyword.arg] = evaluate(machine, keyword.value)
        machine.pending.append(named[keyword.arg])
    del machine.pending[waiting:]
    machine.meter.step(node.lineno)
    return apply(machine, function, args, named, evaluate)


def apply(machine: Machine, function: Value, args: list[Value], named: dict[str, Value], evaluate: Evaluate) -> Value:
    """Apply a function to arguments.

    Raises:
        CostError: The value is not a function, or does not accept the arguments.
    """
    if isinstance(function, Function):
        for value in (*args, *named.values()):
            if isinstance(value, Seq) and value.kind == "generator":
                raise machine.meter.fault("wrong_type", "a generator goes into sum, max and the like; write a list")
        return invoke(machine, function, args, named, evaluate)
    if isinstance(function, Builtin):
        if function.name != "sum" and any(_has_gaps(value) for value in args):
            raise machine.meter.fault(
                "unset",
                "a list or dict with entries that are set in some states only goes into "
                "sum(...) alone; give every entry a value in every state",
            )
        return bounded(machine.meter, function.call(machine.meter, args, named))
    raise machine.meter.fault("wrong_call", f"{kind(function)} cannot be called")


def _has_gaps(value: Value) -> bool:
    if isinstance(value, Seq):
        return any(isinstance(item, Partial) for item in value.items)
    return isinstance(value, DictValue) and any(isinstance(item, Partial) for item in value.items.values())


def _reflect(machine: Machine, node: ast.Call, what: str, evaluate: Evaluate) -> Value:
    """Evaluate `hasattr(self, "name")` or `getattr(self, "name", default)`, decided once for the schema."""
    literal = node.args[1] if len(node.args) > 1 else None
    if node.keywords or not isinstance(literal, ast.Constant) or not isinstance(literal.value, str):
        raise machine.meter.fault("not_allowed", f"{what} takes self and the name as a literal text")
    if not isinstance(evaluate(machine, node.args[0]), State):
        raise machine.meter.fault("not_allowed", f"{what} applies to self only")
    name = literal.value
    if "__" in name or len(node.args) > (3 if what == "getattr" else 2):
        raise machine.meter.fault("not_allowed", f"{what}(self, {name!r}) is not available")
    known = machine.space.has(name)
    if what == "hasattr":
        return known
    default = evaluate(machine, node.args[2]) if len(node.args) == 3 else None
    if known:
        return machine.space.read(machine.meter, name)
    if len(node.args) == 2:
        raise machine.space.unknown(machine.meter, name)
    return default


def invoke(
    machine: Machine, function: Function, args: list[Value], named: dict[str, Value], evaluate: Evaluate
) -> Value:
    """Run a function of the program.

    Raises:
        CostError: The arguments do not fit, the calls are too deep, or some state gets no value.
    """
    if len(machine.stack) > machine.meter.cfg.calls + 1:
        raise machine.meter.fault(
            "calls", f"functions call one another more than {machine.meter.cfg.calls} deep; recursion is not available"
        )
    frame = Scope(function.frame, function.names, variables=bind(machine, function, args, named))
    mask, loops, line = machine.meter.mask, machine.loops, machine.meter.line
    machine.stack.append(frame)
    machine.loops = []
    if isinstance(function.body, ast.expr):
        found = evaluate(machine, function.body)
    else:
        if machine.run(machine, function.body):
            leave(machine, None, None)
        found = outcome(machine, frame, function.name)[0]
    machine.stack.pop()
    machine.meter.mask, machine.loops, machine.meter.line = mask, loops, line
    return found


def bind(machine: Machine, function: Function, args: list[Value], named: dict[str, Value]) -> dict[str, Value]:
    """Bind arguments to parameter names.

    Raises:
        CostError: They do not fit.
    """
    positional = [a.arg for a in [*function.arguments.posonlyargs, *function.arguments.args]]
    wanted = [*positional, *(a.arg for a in function.arguments.kwonlyargs)]
    found = {**function.defaults, **dict(zip(positional, args, strict=False)), **named}
    doubled = [name for name in positional[: len(args)] if name in named]
    if len(args) > len(positional) or doubled or set(found) != set(wanted):
        raise machine.meter.fault("wrong_call", f"{function.name} takes ({', '.join(wanted)})")
    return found


def leave(machine: Machine, value: Value, ledger: Value) -> None:
    """Record that the active states return a value."""
    machine.exited += 1
    machine.frame.exits.append((machine.meter.mask, value, ledger))


def outcome(machine: Machine, frame: Scope, name: str) -> tuple[Value, Value]:
    """Return the result of a function: for every state the value of its first `return`, with the addends of a sum.

    Raises:
        CostError: Some states return nothing, or another kind of value than the others.
    """
    *earlier, (mask, value, ledger) = frame.exits
    if value is None and earlier and (mask is None or not bool(np.any(mask))):
        _, value, ledger = earlier.pop()
    for condition, other, other_ledger in reversed(earlier):
        if condition is None:
            value, ledger = other, other_ledger
            continue
        if (other is None) != (value is None):
            raise machine.meter.fault(
                "no_return", f"{name} returns a value in some states and nothing in others; end it with a return"
            )
        value = merge(machine.meter, condition, other, value)
        ledger = merge(machine.meter, condition, other_ledger, ledger)
    return machine.usable(value, name), ledger
