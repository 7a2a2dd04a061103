"""Samples of the belief about masses and frictions, for plans that must hold under all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coral.config import Count, NonNegative
from coral.contact.scene.trial import PhysicalParameters


@dataclass(frozen=True, kw_only=True)
class UncertaintyCfg:
    """Number and spread of the beliefs under which a plan is rolled out."""

    sets: Count = 1
    """Number of beliefs: the estimate, and samples around it. Each costs a full set of rollouts. 1: the estimate
    alone, as in the paper, without an effect of `risk`."""
    mass: NonNegative = 0.3
    """Standard deviation of the logarithm of a mass: about its relative error."""
    friction: NonNegative = 0.2
    """Standard deviation of the logarithm of a friction."""


def sample_beliefs(
    belief: Mapping[str, PhysicalParameters], cfg: UncertaintyCfg, rng: np.random.Generator
) -> list[Mapping[str, PhysicalParameters]]:
    """Return the belief itself, then samples around it: each mass and friction log-normal, independently.

    Args:
        belief: Estimates for each object.
        cfg: Number and spread.
        rng: Random generator of the samples.
    """

    def other(one: PhysicalParameters) -> PhysicalParameters:
        mass, friction = np.exp(rng.normal(scale=[cfg.mass, cfg.friction]))
        return PhysicalParameters(one.mass_kg * float(mass), one.friction * float(friction))

    return [belief, *({name: other(one) for name, one in belief.items()} for _ in range(cfg.sets - 1))]
