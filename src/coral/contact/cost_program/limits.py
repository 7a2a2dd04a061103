"""Resource limits of a cost program, and the meter that enforces them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context
from coral.contact.cost_program.errors import CostError

Mask = NDArray[np.bool_]


MOST_CHARACTERS = 20_000
"""Length of the source text. The paper's example (A.6) takes about 550 steps and 350 arrays."""
MOST_NODES = 6_000
"""Number of its syntax nodes."""
MOST_DEPTH = 48
"""Nesting of expressions and blocks."""
MOST_STEPS = 20_000
"""Number of nodes evaluated for one batch."""
MOST_ARRAYS = 4_000
"""Number of arrays for one batch, so that memory stays below arrays * K * H * 8 bytes."""
MOST_OPERATIONS = 100_000
"""Number of operations on single numbers and of entries counted, constants included."""
MOST_TURNS = 64
"""Number of iterations of one loop."""
MOST_ITEMS = 1_024
"""Number of entries of one list, tuple, dict or vector, nested ones included."""
MOST_CALLS = 8
"""Nesting of the program's own functions."""
MOST_TERMS = 64
"""Number of named terms."""


@dataclass
class Meter:
    """One evaluation: its inputs, its current line, and the resources it has used."""

    context: Context
    """The batch of states."""
    line: int = 0
    """Line being evaluated."""
    mask: Mask | None = None
    """States for which the present statement counts, Shape=(K, H); None for all."""
    steps: int = 0
    """Nodes evaluated so far."""
    arrays: int = 0
    """Arrays made so far."""
    operations: int = 0
    """Operations on single numbers so far."""
    cache: dict[str, NDArray[Any]] = field(default_factory=dict)
    """Quantities read so far."""
    watched: bool = False
    """Whether to record where a value stops being finite."""
    lost: tuple[int, str] | None = None
    """Line and text of the first expression that was not finite in some state in which it counted."""

    def step(self, line: int) -> None:
        """Count one node of the syntax tree."""
        self.line = line
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise self.fault("steps", f"the cost takes more than {MOST_STEPS} steps; shorten its loops")

    def made(self, count: int = 1) -> None:
        """Count arrays that are about to be created."""
        self.arrays += count
        if self.arrays > MOST_ARRAYS:
            raise self.fault("memory", f"the cost makes more than {MOST_ARRAYS} arrays; shorten its loops")

    def spend(self, count: int = 1) -> None:
        """Count operations on single numbers, which cost time whether or not they depend on the state."""
        self.operations += count
        if self.operations > MOST_OPERATIONS:
            raise self.fault("steps", f"the cost takes more than {MOST_OPERATIONS} operations; shorten its loops")

    def fault(self, code: str, text: str) -> CostError:
        """Make the error for the line being evaluated."""
        return CostError(code, text, self.line)
