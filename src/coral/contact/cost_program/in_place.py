"""Changes of a list, dict or array in place, allowed only without a second reference: the result is then Python's."""

from __future__ import annotations

from coral.contact.cost_program.machine import Machine
from coral.contact.cost_program.sharing import memory
from coral.contact.cost_program.values import (
    Builtin,
    DictValue,
    Function,
    Marks,
    Partial,
    Scope,
    Seq,
    Value,
    Vec,
)


def check_unshared(machine: Machine, value: Value, name: str, at: Value = None) -> None:
    """Reject an in-place change of a container that a second name refers to.

    Args:
        machine: The evaluation.
        value: The container that changes.
        name: Variable under which it changes.
        at: Index or key of the only entry that changes; None if any may.

    Raises:
        CostError: Another variable, container, closure, pending operand, running loop or the state sees the change.
    """
    marks = memory(value)
    count = Holders(marks)
    count.found += bool(marks & machine.meter.state_marks)  # `self` holds it, too
    for frame in machine.stack:
        count.scope(frame)
    for held in machine.pending:
        count.value(held)
    if count.found > 1 or not all(_is_consumed(source, marks, turn, at) for source, turn in machine.looping()):
        raise machine.meter.fault(
            "shared",
            f"{name!r} would change in place while another name, list, loop or self holds the same value; "
            f"copy it first, as with {name}.copy()",
        )


def _is_consumed(source: Value, marks: Marks, turn: int, at: Value) -> bool:
    """Check whether a loop over a container is already past the entry that changes."""
    if not memory(source) & marks:
        return True
    if isinstance(source, DictValue):
        return at in list(source.items)[: turn + 1]
    if isinstance(source, Seq) and source.kind == "view":
        return any(at == (item.items[0] if isinstance(item, Seq) else item) for item in source.items[: turn + 1])
    if isinstance(source, Seq) and source.kind in ("reversed", "values"):
        return False
    return isinstance(at, int) and 0 <= at <= turn


class Holders:
    """Counts the references to some memory.

    Args:
        marks: The memory.
    """

    def __init__(self, marks: Marks) -> None:
        self.marks, self.found = marks, 0
        self.seen: set[int] = set()

    def scope(self, frame: Scope | None) -> None:
        """Count the variables of a frame and of the frames around it."""
        while frame is not None and id(frame) not in self.seen:
            self.seen.add(id(frame))
            for held in frame.variables.values():
                self.value(held)
            frame = frame.parent

    def value(self, held: Value) -> None:
        """Count a value and what is inside it."""
        if isinstance(held, Vec | Seq | DictValue):
            self.found += bool(memory(held) & self.marks)
            if isinstance(held, Vec):
                return
            for item in held.items.values() if isinstance(held, DictValue) else held.items:
                self.value(item)
        elif isinstance(held, Partial):
            self.value(held.value)
        elif isinstance(held, Builtin):
            self.value(held.bound)
        elif isinstance(held, Function) and id(held) not in self.seen:
            self.seen.add(id(held))
            for item in held.defaults.values():
                self.value(item)
            self.scope(held.frame)


def is_inside(part: Value, whole: Value) -> bool:
    """Check whether a container is an entry or a view of another one, not a copy."""
    count = Holders(memory(part))
    count.value(whole)
    return count.found > 0
