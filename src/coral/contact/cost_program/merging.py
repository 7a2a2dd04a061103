"""Merging the results of two branches: each state keeps the values of the branch that it took."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from coral.contact.cost_program.arithmetic import where
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.values import Partial, Poison, Value, is_number, is_vector, kind

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
    for value in (a, b):
        if isinstance(value, Poison):
            return value
    if isinstance(a, Partial) or isinstance(b, Partial):
        return _merge_partial(meter, condition, a, b)
    if isinstance(a, int | float | str) and type(a) is type(b) and repr(a) == repr(b):
        return a
    if (is_number(a) and is_number(b)) or (is_vector(a) and is_vector(b) and len(a) == len(b)):
        return where(meter, condition, a, b)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple) and type(a) is type(b) and len(a) == len(b):
        return type(a)(merge(meter, condition, x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return merge_variables(meter, condition, a, b)
    return Poison(f"it is {kind(a)} in some states and {kind(b)} in others")


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
