"""The values of a cost program: a closed set, so that nothing else can be reached from inside it.

A number is a Python number, or an array of one number per state, Shape=(K, H) or (1, 1), of float64 or bool. A vector
is an array with its entries first, Shape=(n, K, H) or (n, 1, 1), so that it meets numbers and vectors as in NumPy for
one state. Lists, tuples, dicts, texts and None are Python's own. No value is changed once it is made: setting the entry
of a dict binds its name to another one, so that a second name for a value never matters.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost_program.limits import MOST_ITEMS, Mask, Meter

Value = object
Array = NDArray[Any]
Number = bool | int | float | Array


@dataclass(frozen=True, eq=False)
class Partial:
    """A value that is set in some states only."""

    value: Value
    """The value."""
    mask: Mask
    """Where it is set, Shape=(K, H)."""


@dataclass(frozen=True, eq=False)
class Poison:
    """A value that cannot be used, with the reason."""

    reason: str


@dataclass(frozen=True, eq=False)
class Module:
    """The module `np`, `np.linalg` or `math`."""

    name: str


class State:
    """The object `self`."""


@dataclass(frozen=True, eq=False)
class Builtin:
    """A built-in function of the language."""

    name: str
    """Its name."""
    call: Callable[[Meter, list[Value], dict[str, Value]], Value]
    """The function."""


@dataclass(eq=False)
class Scope:
    """The variables of one running function."""

    parent: Scope | None
    """Frame of the function around its definition."""
    names: frozenset[str]
    """Its own names."""
    variables: dict[str, Value] = field(default_factory=dict)
    exits: list[tuple[Mask | None, Value]] = field(default_factory=list)
    """What was returned, and in which states; None for all."""


@dataclass(frozen=True, eq=False)
class Function:
    """A function that the program defines."""

    name: str
    arguments: list[str]
    body: list[ast.stmt] | ast.expr
    defaults: dict[str, Value]
    frame: Scope
    names: frozenset[str]


def is_number(value: Value) -> TypeGuard[Number]:
    """Check whether the value is a number or a truth value, constant or per state."""
    return isinstance(value, int | float) or (isinstance(value, np.ndarray) and value.ndim == 2)


def is_vector(value: Value) -> TypeGuard[Array]:
    """Check whether the value is a vector."""
    return isinstance(value, np.ndarray) and value.ndim == 3


def kind(value: Value) -> str:
    """Return the word for a value in an error message."""
    if is_vector(value):
        return f"a vector of {len(value)}"
    if is_number(value):
        return "a truth value" if isinstance(value, bool) or getattr(value, "dtype", None) == np.bool_ else "a number"
    if isinstance(value, list | tuple):
        return f"a {type(value).__name__} of {len(value)}"
    words = {
        dict: "a dict",
        str: "a text",
        Function: "a function",
        Builtin: "a function",
        Module: "a module",
        State: "self",
        type(None): "None",
        Partial: "a value that is not set in every state",
        Poison: "a value of two kinds",
    }
    return words.get(type(value), "such a value")


def entries(meter: Meter, value: Value) -> Sequence[Value]:
    """Return the entries that a loop over the value visits."""
    if isinstance(value, list | tuple | dict) or is_vector(value):
        return list(value)
    raise meter.fault("wrong_type", f"{kind(value)} cannot be looped over")


def weight(value: Value, cap: int) -> int:
    """Count the entries of a container, nested ones included, up to slightly above `cap`."""
    if is_vector(value):
        return 1 + len(value)
    total = 1
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ():
        total += weight(item, cap - total)
        if total > cap:
            break
    return total


def bounded(meter: Meter, value: Value) -> Value:
    """Return the container after checking its size."""
    if not isinstance(value, list | tuple | dict) and not is_vector(value):
        return value
    found = weight(value, MOST_ITEMS)
    meter.spend(found)
    if found > MOST_ITEMS:
        raise meter.fault("memory", f"{kind(value)} holds more than {MOST_ITEMS} entries")
    return value
