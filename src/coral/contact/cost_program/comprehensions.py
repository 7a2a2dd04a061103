"""Comprehensions of lists and generators."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from coral.contact.cost_program.binding import storable, unpack
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.scalars import truth
from coral.contact.cost_program.values import Scope, Seq, Value, bounded, entries


def comprehend(machine: Machine, node: Any, evaluate: Callable[[Machine, ast.expr], Value]) -> Value:
    """Evaluate a comprehension.

    Raises:
        CostError: It cannot be evaluated, or which entries it has depends on the state.
    """
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
            found.append(storable(machine, evaluate(machine, node.elt)))
            return
        generator = node.generators[level]
        for item in entries(machine.meter, evaluate(machine, generator.iter) if level else outermost):
            unpack(machine, generator.target, item)
            if all(map(is_met, generator.ifs)):
                generate(level + 1)

    generate(0)
    machine.stack.pop()
    return bounded(machine.meter, Seq(tuple(found), "iterator" if isinstance(node, ast.GeneratorExp) else "list"))
