"""Attributes, calls, the quantities of `self`: look-ups in tables, and the only ways from a value to another one."""

from __future__ import annotations

import ast
from collections.abc import Callable

import numpy as np

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost_program.library import CONSTANTS, MODULES, VECTOR_METHODS, instead
from coral.contact.cost_program.limits import MOST_CALLS, Meter
from coral.contact.cost_program.machine import Machine, merge
from coral.contact.cost_program.values import (
    Array,
    Builtin,
    Function,
    Module,
    Partial,
    Scope,
    State,
    Value,
    bounded,
    is_vector,
    kind,
)
from coral.errors import nearest

Evaluate = Callable[[Machine, ast.expr], Value]


def attribute(machine: Machine, base: Value, name: str) -> Value:
    """Evaluate `base.name`."""
    if isinstance(base, State):
        return read_quantity(machine.meter, machine.schema, name)
    if isinstance(base, Module):
        return _member(machine, base, name)
    if is_vector(base) and name in VECTOR_METHODS:
        method = VECTOR_METHODS[name]
        return Builtin(name, lambda meter, args, named: method.call(meter, [base, *args], named))
    if isinstance(base, dict) and name in TABLE_METHODS:
        found = TABLE_METHODS[name](base)

        def entries(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
            if args or named:
                raise meter.fault("wrong_call", f"{name} takes no arguments")
            return found

        return Builtin(name, entries)
    changes = "; lists, dicts and arrays are not changed: make a new one, as with xs = xs + [x]"
    known = list(VECTOR_METHODS) if is_vector(base) else list(TABLE_METHODS) * isinstance(base, dict)
    hint = changes if name in CHANGERS else f"{nearest(name, known)}; it has {', '.join(known)}" if known else ""
    raise machine.meter.fault("unknown_attribute", f"{kind(base)} has no {name!r}{hint}")


def _member(machine: Machine, module: Module, name: str) -> Value:
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


def read_quantity(meter: Meter, schema: Schema, name: str) -> Value:
    """Return the value of `self.name`."""
    if name not in schema:
        sure = nearest(name, schema, likeness=0.8)
        listed = f"{nearest(name, schema)}; it has {', '.join(sorted(schema))}"
        raise meter.fault("unknown_state", f"the state has no {name!r}{sure or listed}")
    if name not in meter.cache:
        meter.cache[name] = _read(meter, schema[name], name)
    return meter.cache[name]


def _read(meter: Meter, quantity: Quantity, name: str) -> Array:
    """Return a contiguous array: the same memory layout for every batch, so the same rounding."""
    if name not in meter.context:
        raise meter.fault("missing_state", f"the batch lacks {name}")
    values = np.asarray(meter.context[name], dtype=np.float64)
    fits = values.ndim == (3 if quantity.size else 2) and all(
        n in (1, m) for n, m in zip(values.shape[:2], meter.context.shape, strict=True)
    )
    if not fits or (quantity.size and values.shape[2] != quantity.size):
        raise meter.fault("missing_state", f"{name} has shape {values.shape} in a batch of {meter.context.shape}")
    meter.made(max(quantity.size, 1))
    if quantity.truth and not quantity.size:
        return np.not_equal(values, 0)
    return np.ascontiguousarray(values.transpose(2, 0, 1) if quantity.size else values)


TABLE_METHODS: dict[str, Callable[[dict[Value, Value]], list[Value]]] = {
    "items": lambda table: list(table.items()),
    "keys": list,
    "values": lambda table: list(table.values()),
}
CHANGERS = ("append", "extend", "insert", "pop", "remove", "clear", "sort", "reverse", "update", "setdefault", "fill")
"""Methods that would change a list, a dict or an array."""


def call(machine: Machine, node: ast.Call, evaluate: Evaluate) -> Value:
    """Evaluate a call."""
    if isinstance(node.func, ast.Attribute):
        base = evaluate(machine, node.func.value)
        machine.meter.line = node.lineno
        function = attribute(machine, base, node.func.attr)
    else:
        function = evaluate(machine, node.func)
    args = [evaluate(machine, item) for item in node.args]
    named: dict[str, Value] = {}
    for keyword in node.keywords:
        if keyword.arg is None:
            raise machine.meter.fault("not_allowed", "a cost has no ** in calls; write the keywords one by one")
        named[keyword.arg] = evaluate(machine, keyword.value)
    machine.meter.step(node.lineno)
    return apply(machine, function, args, named, evaluate)


def apply(machine: Machine, function: Value, args: list[Value], named: dict[str, Value], evaluate: Evaluate) -> Value:
    """Apply a function to arguments."""
    if isinstance(function, Function):
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
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return any(isinstance(item, Partial) for item in items)


def invoke(
    machine: Machine, function: Function, args: list[Value], named: dict[str, Value], evaluate: Evaluate
) -> Value:
    """Run a function of the program."""
    if len(machine.stack) > MOST_CALLS + 1:
        raise machine.meter.fault(
            "calls", f"functions call one another more than {MOST_CALLS} deep; recursion is not available"
        )
    frame = Scope(function.frame, function.names, variables=bind(machine, function, args, named))
    mask, line = machine.meter.mask, machine.meter.line
    machine.stack.append(frame)
    if isinstance(function.body, ast.expr):
        found = evaluate(machine, function.body)
    else:
        if machine.run(machine, function.body):
            leave(machine, None)
        found = outcome(machine, frame, function.name)
    machine.stack.pop()
    machine.meter.mask, machine.meter.line = mask, line
    return found


def bind(machine: Machine, function: Function, args: list[Value], named: dict[str, Value]) -> dict[str, Value]:
    """Bind arguments to parameter names."""
    wanted = function.arguments
    given = {**dict(zip(wanted, args, strict=False)), **named}
    doubled = [name for name in wanted[: len(args)] if name in named]
    found = {**function.defaults, **given}
    if len(args) > len(wanted) or doubled or set(found) != set(wanted):
        raise machine.meter.fault("wrong_call", f"{function.name} takes ({', '.join(wanted)})")
    return found


def leave(machine: Machine, value: Value) -> None:
    """Record that the active states return a value."""
    machine.frame.exits.append((machine.meter.mask, value))


def outcome(machine: Machine, frame: Scope, name: str) -> Value:
    """Return the result of a function: for every state the value of its first `return`."""
    if machine.left:
        raise machine.meter.fault("syntax", f"not Python: `{machine.left}` outside a loop")
    *earlier, (mask, value) = frame.exits
    if value is None and earlier and (mask is None or not bool(np.any(mask))):
        _, value = earlier.pop()
    for condition, other in reversed(earlier):
        if condition is None:
            value = other
            continue
        if (other is None) != (value is None):
            raise machine.meter.fault(
                "no_return", f"{name} returns a value in some states and nothing in others; end it with a return"
            )
        value = merge(machine.meter, condition, other, value)
    return machine.usable(value, name)
