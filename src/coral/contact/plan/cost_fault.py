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


@dataclass(frozen=True, kw_only=True)
class CostCheckCfg:
    """Thresholds of the checks."""

    states: int = 600
    """Number of sampled states that are examined."""
    reach_m: float = 0.015
    """A reach term that falls below this may approach zero; a fingertip is about as thick."""
    near_m: float = 0.06
    """The closest states must be within this distance for a contact there to be what stops the hand."""
    force_n: float = 0.5
    """Force on the hand that counts as contact."""
    opening_m: float = 0.08
    """Widest opening of the fingers (Panda hand); they cannot straddle anything wider."""
    rise: float = 0.05
    """Rise of the cost on the path to a target that counts as a barrier, relative to its range on the path."""
    paths: int = 16
    """Number of approaches tried."""


@runtime_checkable
class Traceable(Protocol):
    """A cost that reports the distances it computes."""

    def trace(self, state: Context, zeroed: int = -1) -> Traced:
        """Return terms and distances, with the distance number `zeroed` set to 0."""
        ...

    def line(self, number: int) -> str:
        """Return the text of a line."""
        ...

    def term_line(self, term: str) -> int:
        """Return the line of a term."""
        ...
