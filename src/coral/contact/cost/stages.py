"""A strategy is a list of stages: a cost, where to touch, how stiff to be, and when the stage is over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Terms

Array = NDArray[np.float64]
CostFunction = Callable[[Context], Terms]
Test = Callable[[Context], bool]


@dataclass(frozen=True)
class Guide:
    """Points that some of the samples head for (the candidates of Eq. 3, or any others)."""

    points: Callable[[Context], Array]
    """From the state now, Shape=(n, 3) m in the world for the tool to reach."""
    quaternion: Callable[[Context], Array] | None = None
    """From the state now, Shape=(4,) for the tool to take there; None leaves it."""
    opening_m: float | None = None
    """Wanted there; None leaves it."""


@dataclass(frozen=True)
class Stage:
    """One phase of a task."""

    name: str
    """For logs."""
    cost: CostFunction
    """Running cost (Eq. 5) as named terms."""
    guides: tuple[Guide, ...] = ()
    """Where to touch."""
    stiffness_n_m: float = 600.0
    """Of the hand; soft where a force matters."""
    until: Test | None = None
    """Over when this holds of the state now; None: never."""
    back: tuple[str, Test] | None = None
    """Another stage to return to when its test holds, as after a lost grasp."""
    sigma: float | tuple[float, float, float, float, float, float, float] = 1.0
    """Factor on the sampling noise; or seven, for the target's x, y, z, its rotation about x, y, z of the hand and the
    opening."""


@dataclass(frozen=True)
class Strategy:
    """Stages in order; one alone is a single-stage cost."""

    name: str
    stages: tuple[Stage, ...]
    notes: str = field(default="", compare=False)

    def stage(self, name: str) -> int:
        """Index of a stage by its name."""
        return next(k for k, stage in enumerate(self.stages) if stage.name == name)


class Progress:
    """The active stage of a strategy."""

    def __init__(self, strategy: Strategy) -> None:
        self.strategy, self.index = strategy, 0

    @property
    def stage(self) -> Stage:
        """The active stage."""
        return self.strategy.stages[self.index]

    def update(self, now: Context) -> bool:
        """Update the active stage from the present state, a batch of one; true when it changed."""
        stage = self.stage
        if stage.back is not None and stage.back[1](now):
            self.index = self.strategy.stage(stage.back[0])
            return True
        if stage.until is not None and self.index + 1 < len(self.strategy.stages) and stage.until(now):
            self.index += 1
            return True
        return False
