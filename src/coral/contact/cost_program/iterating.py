"""Iterating: the entries of a loop, and iterators, which Python evaluates lazily and only once."""

from __future__ import annotations

from collections.abc import Iterable

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.sharing import ONE_PASS, memory
from coral.contact.cost_program.values import DictValue, Seq, Value, Vec, kind


def entries(meter: Meter, value: Value) -> tuple[Value, ...]:
    """Return the entries that a loop over the value visits.

    Raises:
        CostError: The value is not iterable.
    """
    if isinstance(value, Seq):
        if value.used:
            raise meter.fault("wrong_type", "an iterator is used up after one pass; write list(...) around it")
        value.used = value.kind in ONE_PASS
        return value.items
    if isinstance(value, Vec):
        return value.items
    if isinstance(value, DictValue):
        return tuple(value.items)
    raise meter.fault("wrong_type", f"{kind(value)} cannot be looped over")


def iterator(items: Iterable[Value], *sources: Value) -> Seq:
    """Make an iterator that computes item by item while it runs over the sources."""
    return Seq(tuple(items), "iterator", frozenset().union(*(memory(source) for source in sources)))
