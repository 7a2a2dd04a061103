"""Is the planner too weak? Plan the same moment with more samples, and see whether the expected cost falls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from coral.config import Fraction
from coral.contact.control.hand_controllers import AdjustableController
from coral.contact.control.hand_plan import HandPlan
from coral.contact.cost.stages import Stage
from coral.contact.scene.observation import Observation

SEED = 20_262
"""The same samples at every call: one moment has one verdict."""


@dataclass(frozen=True, kw_only=True)
class EffortCfg:
    """How a planner that is stuck is tried with more samples, before its plan is thrown away."""

    retries: Annotated[int, Field(ge=0, le=100)] = 1
    """How often in an episode the planner may get more samples. 0: never."""
    factor: Annotated[int, Field(ge=2, le=100)] = 4
    """Factor on the number of samples."""
    plans: Annotated[int, Field(ge=1, le=100)] = 4
    """Plans in a row, each from the one before, with the present number of samples and with more."""
    gain: Fraction = 0.1
    """The planner is too weak if more samples lower the expected cost by this share of the sum of its terms'
    magnitudes, five times what counts as progress."""


@dataclass(frozen=True, eq=False)
class EffortProbe:
    """What more samples found at one moment."""

    samples: int
    """The present number."""
    more: int
    """The larger number."""
    cost: float
    """Lowest expected cost with the present number."""
    lower: float
    """Lowest expected cost with the larger one."""
    gain: float
    """The difference, as a share of the sum of the terms' magnitudes."""
    plans: int
    """Plans made for it, counted in plans with the present number of samples: the time that it took."""
    stronger: AdjustableController
    """The planner with more samples and the plan that it found."""

    def sentence(self) -> str:
        """Return the evidence in a sentence, for prompts and events."""
        return (
            f"With {self.more} samples in place of {self.samples} the planner expects a cost of {self.lower:.3g} "
            f"in place of {self.cost:.3g}."
        )


def probe_effort(
    controller: AdjustableController,
    now: Observation,
    stage: Stage,
    step: int,
    cfg: EffortCfg,
    since: Observation | None = None,
) -> EffortProbe:
    """Plan one moment several times with the present number of samples, and with more; neither changes the controller.

    Both start from the present plan, so that only the number of samples makes the difference.

    Args:
        controller: The planner.
        now: The present state.
        stage: The active stage.
        step: Control steps since the episode began.
        cfg: Effort.
        since: The observation with which the stage began; None if it begins now.

    Raises:
        CostError: The stage's cost cannot be evaluated.
    """
    samples = controller.samples
    found: list[HandPlan] = []
    for count in (samples, cfg.factor * samples):
        other = controller.with_samples(count, np.random.default_rng(SEED))
        plans = [other.plan(now, stage, step, since) for _ in range(cfg.plans)]
        found.append(min((plan for plan in plans if plan.valid), key=lambda plan: plan.cost, default=plans[-1]))
    present, better = found
    whole = sum(abs(value) for value in present.terms.values())
    gain = (present.cost - better.cost) / whole if whole and better.valid else 0.0
    gain = float(gain) if np.isfinite(gain) else 0.0
    made = cfg.plans * (1 + cfg.factor)
    return EffortProbe(samples, cfg.factor * samples, present.cost, better.cost, gain, made, other)
