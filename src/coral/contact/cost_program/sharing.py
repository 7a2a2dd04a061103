"""Shared memory of containers: an in-place change of one is visible through the others.

Values of the interpreter never change; an in-place change makes a new value for one name. This equals Python as long as
no second name sees the change, so every list, dict and array carries marks of the memory that it represents.
"""

from __future__ import annotations

from itertools import count

from coral.contact.cost_program.values import DictValue, Marks, Seq, Value, Vec

ONE_PASS = ("iterator", "generator")
"""Kinds of `Seq` that allow only one pass."""
LAZY = (*ONE_PASS, "view", "values")
"""Kinds of `Seq` other than lists: they have no entries by number, and make no array."""
_numbers = count()


def marks_of(value: Vec | Seq | DictValue) -> Marks:
    """Return the marks of a container's memory; a container without marks gets a new one."""
    if value.marks is None:
        value.marks = frozenset((next(_numbers),))
    return value.marks


def memory(value: Value) -> Marks:
    """Return the marks of all memory that an in-place change touches: for a matrix, also that of its rows."""
    if not isinstance(value, Vec | Seq | DictValue):
        return frozenset()
    found = marks_of(value)
    if isinstance(value, Vec) and value.items and isinstance(value.items[0], Vec):
        return found.union(*(memory(row) for row in value.items))
    return found


def view(items: tuple[Value, ...], *bases: Value, order: str = "") -> Vec:
    """Make a vector that NumPy would make as a view of others."""
    return Vec(items, order, frozenset().union(*(memory(base) for base in bases)))


def renewed(value: Value) -> Value:
    """Return the same numbers in memory of their own."""
    return Vec(tuple(renewed(item) for item in value.items), value.order) if isinstance(value, Vec) else value
