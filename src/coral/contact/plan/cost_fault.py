"""Faults that a check of a cost reports, and the interface of a cost that can be checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from coral.contact.cost.context import Context
from coral.contact.cost_program.trace import Traced


@dataclass(frozen=True)
class CostFault:
    """One fault of a cost."""

    code: str
    """One of `coral.contact.cost_program.CODES`."""
    line: int
    """Line of the program; 0 if the fault is in no single line."""
    reason: str
    """A sentence for the author of the cost."""
    fatal: bool = True
    """Whether the fault forbids using the cost."""
    stage: str = ""
    """Stage of the plan; "" if the fault is in none, or the cost is alone."""


@runtime_checkable
class Traceable(Protocol):
    """A cost that reports the distances it computes."""

    def trace(self, state: Context) -> Traced:
        """Return terms and distances."""

    def line(self, number: int) -> str:
        """Return the text of a line."""


def quoted(cost: object, line: int) -> str:
    """Return "line N (`text`): " for the start of a reason; "" if the line is unknown."""
    return f"line {line} (`{cost.line(line)}`): " if line and isinstance(cost, Traceable) else ""
