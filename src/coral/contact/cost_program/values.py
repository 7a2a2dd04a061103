"""The values of a cost program: a closed set, so that nothing else can be reached from inside it.

A number is a Python number, or an array of one number per state, Shape=(K, H), of float64, int64 or bool. A vector is
a tuple of numbers, never an array with one more axis, so that code written for one state runs on a batch without any
guess about axes. Nothing but a dict can be changed, so a second name for a value never matters.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost_program.limits import Mask, Meter

Value = object
Number = bool | int | float | NDArray[np.float64] | NDArray[np.int64] | NDArray[np.bool_]
NUMBER = (bool, int, float, np.ndarray)


@dataclass(frozen=True, eq=False, slots=True)
class Vec:
    """A vector: what NumPy calls an array with one axis."""

    items: tuple[Value, ...]
    """Its numbers."""


@dataclass(frozen=True, eq=False, slots=True)
class Seq:
    """A list, or another iterable."""

    items: tuple[Value, ...]
    """The entries."""
    kind: str = "list"
    """"list", "tuple" or "range"; "iterator" for what Python computes on demand, which is used where it is made."""


@dataclass(eq=False, slots=True)
class DictValue:
    """A dict with texts or integers as keys."""

    items: dict[Value, Value]
    """The entries."""
    named: bool = False
    """Whether a name or a container holds it."""
    shared: bool = False
    """Whether a second one does, so that it cannot be changed any more."""


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


def kind(value: Value) -> str:
    """Return the word for a value in an error message."""
    if isinstance(value, np.ndarray):
        return "a truth value" if value.dtype == np.bool_ else "a number"
    if isinstance(value, bool):
        return "a truth value"
    if isinstance(value, int | float):
        return "a number"
    if isinstance(value, Vec):
        return f"a vector of {len(value.items)}"
    if isinstance(value, Seq):
        return "an iterator" if value.kind == "iterator" else f"a {value.kind} of {len(value.items)}"
    words = {
        DictValue: "a dict",
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


def entries(meter: Meter, value: Value) -> tuple[Value, ...]:
    """Return the entries that a loop over the value visits.

    Raises:
        CostError: The value is not iterable.
    """
    if isinstance(value, Seq | Vec | DictValue):
        return tuple(value.items)
    raise meter.fault("wrong_type", f"{kind(value)} cannot be looped over")


def weight(value: Value, cap: int) -> int:
    """Count the entries of a container, nested ones included, up to slightly above `cap`."""
    total = 1
    items: tuple[Value, ...] = ()
    if isinstance(value, Vec | Seq):
        items = value.items
    elif isinstance(value, DictValue):
        items = tuple(value.items.values())
    for item in items:
        total += 1 if isinstance(item, NUMBER) else weight(item, cap - total)
        if total > cap:
            break
    return total


def bounded(meter: Meter, value: Value) -> Value:
    """Return the container after checking its size.

    Raises:
        CostError: It holds more than the limit.
    """
    if not isinstance(value, Vec | Seq | DictValue):
        return value
    found = weight(value, meter.cfg.items)
    meter.spend(found)
    if found > meter.cfg.items:
        raise meter.fault("memory", f"{kind(value)} holds more than {meter.cfg.items} entries")
    return value
