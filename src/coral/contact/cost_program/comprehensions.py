"""Comprehensions of lists, dicts and generators."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from coral.contact.cost_program.binding import checked_key, unpack
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.limits import Mask
from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.scalars import truth
from coral.contact.cost_program.values import DictValue, Partial, Scope, Seq, Value, bounded


def comprehend(machine: Machine, node: Any, evaluate: Callable[[Machine, ast.expr], Value]) -> Value:
    """Evaluate a comprehension; in the states in which a filter does not hold, its entry is not set.

    Args:
        machine: The evaluation.
        node: The comprehension of a list, a dict or a generator.
        evaluate: Evaluates an expression.

    Raises:
        CostError: It cannot be evaluated.
    """
    names = frozenset(
        item.id for generator in node.generators for item in ast.walk(generator.target) if isinstance(item, ast.Name)
    )
    inner = Scope(machine.frame, names)
    found: list[tuple[Value, Value]] = []
    outermost = evaluate(machine, node.generators[0].iter)  # in the enclosing scope, as in Python
    machine.stack.append(inner)
    machine.branching += 1

    def generate(level: int, mask: Mask | None) -> None:
        if level == len(node.generators):
            if isinstance(node, ast.DictComp):
                pair = checked_key(machine, evaluate(machine, node.key)), evaluate(machine, node.value)
            else:
                pair = None, evaluate(machine, node.elt)
            found.append((pair[0], pair[1] if mask is None else Partial(pair[1], mask)))
            return
        generator = node.generators[level]
        source = evaluate(machine, generator.iter) if level else outermost
        for item in entries(machine.meter, source):
            unpack(machine, generator.target, item)
            before, inside = machine.meter.mask, mask
            keep = True
            for test in generator.ifs:
                met = truth(machine.meter, evaluate(machine, test))
                if isinstance(met, bool):
                    keep = keep and met
                else:
                    machine.meter.mask = machine.narrowed(met, machine.meter.mask)
                    inside = machine.narrowed(met, inside)
                if not keep:
                    break
            if keep:
                generate(level + 1, inside)
            machine.meter.mask = before

    generate(0, None)
    machine.branching -= 1
    machine.stack.pop()
    if isinstance(node, ast.DictComp):
        return bounded(machine.meter, DictValue(dict(found)))
    sort = "generator" if isinstance(node, ast.GeneratorExp) else "list"
    return bounded(machine.meter, Seq(tuple(value for _, value in found), sort))
