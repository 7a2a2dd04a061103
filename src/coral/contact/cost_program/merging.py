"""Merging the results of two branches: each state keeps the values of the branch that it took."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.scalars import is_truth, where
from coral.contact.cost_program.values import NUMBER, DictValue, Partial, Poison, Seq, Value, Vec, kind

MISSING = object()
K = TypeVar("K")


def merge(meter: Meter, condition: Mask, a: Value, b: Value) -> Value:
    """Merge any two values: `a` where the condition holds and `b` elsewhere.

    Values that cannot be merged become unreadable, so that a branch may leave unused values behind.
    """
    if a is b:
        return a
    if a is MISSING:
        return _partial(~condition, b)
    if b is MISSING:
        return _partial(condition, a)
    if isinstance(a, Partial) or isinstance(b, Partial):
        return _merge_partial(meter, condition, a, b)
    if isinstance(a, NUMBER) and isinstance(b, NUMBER):
        if is_truth(a) != is_truth(b):
            return Poison("it is a truth value in some states and a number in others; write float(...) around it")
        if not isinstance(a, np.ndarray) and not isinstance(b, np.ndarray) and type(a) is type(b) and str(a) == str(b):
            return a
        found = where(meter, condition, a, b)
        if any(a is other or b is other for other in meter.zero_axes):
            meter.zero_axes.append(found)
        return found
    if isinstance(a, Vec) and isinstance(b, Vec) and len(a.items) == len(b.items):
        return Vec(_merge_items(meter, condition, a.items, b.items))
    if isinstance(a, Seq) and isinstance(b, Seq) and a.kind == b.kind and len(a.items) == len(b.items):
        return Seq(_merge_items(meter, condition, a.items, b.items), a.kind)
    if isinstance(a, DictValue) and isinstance(b, DictValue):
        merged = merge_variables(meter, condition, a.items, b.items)
        return DictValue(merged, a.named or b.named, a.shared or b.shared)
    if isinstance(a, str) and isinstance(b, str) and a == b:
        return a
    if isinstance(a, Poison):
        return a
    if isinstance(b, Poison):
        return b
    return Poison(f"it is {kind(a)} in some states and {kind(b)} in others")


def _merge_items(meter: Meter, condition: Mask, a: tuple[Value, ...], b: tuple[Value, ...]) -> tuple[Value, ...]:
    return tuple(merge(meter, condition, x, y) for x, y in zip(a, b, strict=True))


def _partial(mask: Mask, value: Value) -> Value:
    if isinstance(value, Poison):
        return value
    if isinstance(value, Partial):
        return Partial(value.value, np.logical_and(mask, value.mask))
    return Partial(value, mask)


def _merge_partial(meter: Meter, condition: Mask, a: Value, b: Value) -> Value:
    meter.made(2)
    everywhere = np.ones((1, 1), dtype=np.bool_)
    mask_a, value_a = (a.mask, a.value) if isinstance(a, Partial) else (everywhere, a)
    mask_b, value_b = (b.mask, b.value) if isinstance(b, Partial) else (everywhere, b)
    joined = merge(meter, condition, value_a, value_b)
    if isinstance(joined, Poison):
        return joined
    return Partial(joined, np.where(condition, mask_a, mask_b))


def merge_variables(meter: Meter, condition: Mask, a: dict[K, Value], b: dict[K, Value]) -> dict[K, Value]:
    """Merge variables or the entries of dicts; what only one side has is set in its states only."""
    names = [*a, *(name for name in b if name not in a)]
    return {name: merge(meter, condition, a.get(name, MISSING), b.get(name, MISSING)) for name in names}


def filled(meter: Meter, value: Value, otherwise: Value) -> Value:
    """Fill in the states in which a value is not set."""
    if isinstance(value, Partial):
        return merge(meter, value.mask, value.value, otherwise)
    return value
