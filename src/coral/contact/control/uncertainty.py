"""Samples of the belief about masses and frictions, for plans that must hold under all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coral.config import Count, NonNegative
from coral.contact.scene.trial import PhysicalParameters


@dataclass(frozen=True, kw_only=True)
class UncertaintyCfg:
    """How many sampled beliefs a plan is rehearsed under, and their spread."""

    sets: Count = 1
    """Beliefs: what is believed, and others drawn around it. Each costs as many rehearsals again. 1: the belief alone,
    as in the paper; `risk` then has nothing to weigh."""
    mass: NonNegative = 0.3
    """Standard deviation of the logarithm of a mass: about the share by which it may be off."""
    friction: NonNegative = 0.2
    """Of a friction."""


def sample_beliefs(
    belief: Mapping[str, PhysicalParameters], cfg: UncertaintyCfg, rng: np.random.Generator
) -> list[Mapping[str, PhysicalParameters]]:
    """The belief itself, then samples around it: each mass and friction log-normal, independently.

    Args:
        belief: What is believed of each object.
        cfg: How many, how far.
        rng: Of the samples.
    """

    def other(one: PhysicalParameters) -> PhysicalParameters:
        mass, friction = np.exp(rng.normal(scale=[cfg.mass, cfg.friction]))
        return PhysicalParameters(one.mass_kg * float(mass), one.friction * float(friction))

    return [belief, *({name: other(one) for name, one in belief.items()} for _ in range(cfg.sets - 1))]
