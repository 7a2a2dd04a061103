"""The values of a cost program: a closed set, so that nothing else can be reached from inside it.

A number is a Python number, or an array of one number per state, Shape=(K, H), of float64, int64 or bool. A vector is
a tuple of numbers, never an array with one more axis, so that code written for one state runs on a batch without any
guess about axes.
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
Marks = frozenset[int]
"""Numbers of pieces of memory."""
NUMBER = (bool, int, float, np.ndarray)


class Vec:
    """A vector, or a matrix as a vector of rows: what NumPy calls an array.

    Args:
        items: Numbers, or vectors of one length.
        order: "wxyz" or "xyzw" when it is known to be a quaternion.
        marks: Its memory, None until asked for; see `sharing.py`.
    """

    __slots__ = ("items", "marks", "order")

    def __init__(self, items: tuple[Value, ...], order: str = "", marks: Marks | None = None) -> None:
        self.items, self.order, self.marks = items, order, marks


class Seq:
    """A list, or another iterable.

    Args:
        items: The entries.
        kind: "list", "tuple" or "range"; "view" (keys or items) or "values" of a dict; "iterator" or "generator", for
            one pass.
        marks: See `Vec`.
    """

    __slots__ = ("items", "kind", "marks", "used")

    def __init__(self, items: tuple[Value, ...], kind: str = "list", marks: Marks | None = None) -> None:
        self.items, self.kind, self.marks, self.used = items, kind, marks, False


class DictValue:
    """A dict with texts or integers as keys.

    Args:
        items: The entries.
        marks: See `Vec`.
    """

    __slots__ = ("items", "marks")

    def __init__(self, items: dict[Value, Value], marks: Marks | None = None) -> None:
        self.items, self.marks = items, marks


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
class BodyHandle:
    """A PyBullet body id, or another handle of the simulator: `hand`, an object, a fixture, or `other`."""

    name: str


@dataclass(frozen=True, eq=False)
class ContactList:
    """A list of contact points, of which only emptiness is known."""

    touching: Mask


@dataclass(frozen=True, eq=False)
class Module:
    """The module `np`, `math` or `p`, or a part of one."""

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
    bound: Value = None
    """The value whose method it is."""


@dataclass(eq=False)
class Scope:
    """The variables of one running function."""

    parent: Scope | None
    """Frame of the function around its definition."""
    names: frozenset[str]
    """Its own names."""
    entry: bool = False
    """Whether it is the cost function itself, whose sums are kept as named terms."""
    variables: dict[str, Value] = field(default_factory=dict)
    exits: list[tuple[Mask | None, Value, Value]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Function:
    """A function that the program defines."""

    name: str
    arguments: ast.arguments
    body: list[ast.stmt] | ast.expr
    defaults: dict[str, Value]
    frame: Scope
    names: frozenset[str]


SEQ_WORDS = {
    "iterator": "an iterator",
    "generator": "a generator",
    "view": "a view of a dict",
    "values": "a view of a dict",
}


def kind(value: Value) -> str:
    """Return the word for a value in an error message."""
    if isinstance(value, np.ndarray):
        return "a truth value" if value.dtype == np.bool_ else "a number"
    if isinstance(value, bool):
        return "a truth value"
    if isinstance(value, int | float):
        return "a number"
    if isinstance(value, Vec):
        return f"a matrix of {len(value.items)} rows" if is_matrix(value) else f"a vector of {len(value.items)}"
    if isinstance(value, Seq):
        return SEQ_WORDS.get(value.kind, f"a {value.kind} of {len(value.items)}")
    words = {
        DictValue: "a dict",
        str: "a text",
        Function: "a function",
        Builtin: "a function",
        Module: "a module",
        State: "self",
        BodyHandle: "a body id",
        ContactList: "a list of contact points",
        type(None): "None",
        Partial: "a value that is not set in every state",
        Poison: "a value of two kinds",
    }
    return words.get(type(value), "such a value")


def is_matrix(value: Value) -> bool:
    """Check whether the value is a vector of vectors."""
    return isinstance(value, Vec) and bool(value.items) and isinstance(value.items[0], Vec)


def depth(value: Value) -> int:
    """Count the axes of an array; a number has none."""
    return (2 if is_matrix(value) else 1) if isinstance(value, Vec) else 0


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
