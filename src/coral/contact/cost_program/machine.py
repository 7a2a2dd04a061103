"""State of a running program: its variables, and the branches that only some states take."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from coral.contact.cost.context import Schema
from coral.contact.cost_program.library import BUILTINS, MODULE_NAMES, instead
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.merging import merge_variables
from coral.contact.cost_program.values import Module, Partial, Poison, Scope, Value
from coral.errors import nearest

Snapshot = list[dict[str, Value]]


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
