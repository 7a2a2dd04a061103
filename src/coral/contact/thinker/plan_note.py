"""What is kept of each plan of the inner loop, for diagnoses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from coral.contact.plan.stage_end import PartReading, StageEnd

if TYPE_CHECKING:
    from coral.contact.thinker.strategist import PlanReport

FORCE_STEPS = 5
"""Control steps over which the predicted force is averaged: a contact chatters from step to step."""


@dataclass(frozen=True)
class PlanNote:
    """What is known of one plan of the inner loop."""

    time_s: float
    stage: str
    terms: Mapping[str, float]
    """Expected value of each term of its cost over the horizon."""
    touched: Mapping[str, tuple[str, ...]]
    """What the parts of the hand touched, as measured."""
    expected_force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Force on the hand (N) that the rollouts predict, the mean of the first `FORCE_STEPS` control steps."""
    sunk_m: Mapping[str, float] = field(default_factory=dict)
    """How deep (m) the hand was inside each object by the believed poses."""
    at_edge: float = 0.0
    """Share of the plan's targets at the edge of the workspace or of the arm's reach."""
    end: tuple[PartReading, ...] = ()
    """The comparisons of the condition that ends the stage, in the measured state; () if unknown."""


def note_of(report: PlanReport, end: StageEnd | None = None) -> PlanNote:
    """Return what is kept of a report, with the end of its stage."""
    plan = report.plan
    force = plan.expected_force
    x, y, z = (0.0, 0.0, 0.0) if force is None else np.mean(np.asarray(force)[:FORCE_STEPS], axis=0)
    return PlanNote(
        report.now.time_s,
        report.stage,
        dict(plan.terms),
        dict(report.touched),
        (float(x), float(y), float(z)),
        dict(report.sunk_m),
        plan.at_edge,
        () if end is None or report.present is None else end.read(report.present),
    )
