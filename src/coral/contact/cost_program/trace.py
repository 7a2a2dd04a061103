"""Record of a traced evaluation: every distance computed, and the place where a value stopped being finite."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Terms

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Distance:
    """One vector length that the program computed."""

    line: int
    """Line of the call."""
    value: Floats
    """Length, broadcastable to Shape=(K, H)."""


@dataclass(frozen=True, eq=False)
class Traced:
    """The terms of a batch, with the distances that the program computed."""

    terms: Terms
    distances: list[Distance]


@dataclass
class Trace:
    """Record of one evaluation."""

    distances: list[Distance] = field(default_factory=list)
    """Distances in the order of evaluation, which is the same for every batch."""
    lost: tuple[int, str] | None = None
    """Line and text of the first expression that was not finite in some state in which it counted."""

    def distance(self, line: int, value: object) -> None:
        """Record a distance."""
        self.distances.append(Distance(line, np.atleast_2d(np.asarray(value, dtype=np.float64))))
