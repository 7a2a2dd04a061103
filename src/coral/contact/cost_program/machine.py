"""State of a running program: its variables, and the branches that only some states take and that are merged again."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from coral.contact.cost.context import Schema
from coral.contact.cost_program.arithmetic import where
from coral.contact.cost_program.library import BUILTINS, MODULE_NAMES, instead
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.values import Module, Partial, Poison, Scope, Value, is_number, is_vector, kind
from coral.errors import nearest

Snapshot = list[dict[str, Value]]
MISSING = object()
K = TypeVar("K")


@dataclass
class Machine:
    """One evaluation of one program."""

    meter: Meter
    """Resources used, and the present line."""
    schema: Schema
    """Quantities of `self`."""
    own_names: Mapping[int, frozenset[str]]
    """Variables of every function, by the identity of its node."""
    run: Callable[[Machine, list[ast.stmt]], bool]
    """Runs the body of a function."""
    stack: list[Scope] = field(default_factory=list)
    """Frames of the running functions, the present one last."""
    conditions: int = 0
    """Depth of the present statement in conditions on the state, within its loop."""
    left: str = ""
    """Which of `break` and `continue` ended the present block, if one did."""

    @property
    def frame(self) -> Scope:
        """Return the variables of the current function."""
        return self.stack[-1]

    def lookup(self, name: str) -> Value:
        """Return the value of a name."""
        frame: Scope | None = self.frame
        while frame is not None:
            if name in frame.variables:
                return self.usable(frame.variables[name], name)
            if name in frame.names:
                raise self.meter.fault("unset", f"{name!r} is read before it is set")
            frame = frame.parent
        if name in BUILTINS:
            return BUILTINS[name]
        if name in MODULE_NAMES:
            return Module(MODULE_NAMES[name])
        if name in self.schema:
            raise self.meter.fault("unknown_name", f"{name!r} is not a variable; did you mean self.{name}?")
        known = [*self.frame.names, *BUILTINS]
        raise self.meter.fault(
            "unknown_name",
            f"{name!r} is not a variable and not a function{instead(name) or nearest(name, known)}; "
            f"there are {', '.join(sorted(BUILTINS))}, np and math",
        )

    def usable(self, value: Value, name: str) -> Value:
        """Check a value that is about to be read."""
        if isinstance(value, Partial):
            if self.meter.mask is None or bool(np.any(np.logical_and(self.meter.mask, ~value.mask))):
                raise self.meter.fault("unset", f"{name!r} is set in some states only; give it a value before the `if`")
            return value.value
        if isinstance(value, Poison):
            raise self.meter.fault("mixed", f"{name!r} cannot be used: {value.reason}")
        return value

    def narrowed(self, condition: Mask, mask: Mask | None) -> Mask:
        """Return the states of `mask` in which the condition holds."""
        self.meter.made()
        return condition if mask is None else np.logical_and(mask, condition)

    def snapshot(self) -> Snapshot:
        """Return the variables of all running functions."""
        return [dict(frame.variables) for frame in self.stack]

    def restore(self, snapshot: Snapshot) -> None:
        """Restore the variables of a snapshot."""
        for frame, variables in zip(self.stack, snapshot, strict=True):
            frame.variables = dict(variables)

    def join(self, condition: Mask, snapshot: Snapshot) -> None:
        """Take the snapshot's variables in the states where the condition holds."""
        for frame, variables in zip(self.stack, snapshot, strict=True):
            frame.variables = merge_variables(self.meter, condition, variables, frame.variables)


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
