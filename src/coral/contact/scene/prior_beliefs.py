"""What is believed of masses and frictions before anything is asked or felt. This is the one place that says it.

A robot that thinks sees shapes. It is not told the ranges in a task file: the truth is drawn from them, so that their
middle would be an answer to the question that the advisor is there for. Until somebody answers, it takes everything for
the same stuff.

Who writes a cost by hand for a task has the task file before his eyes, ranges included, and tunes the cost with them.
What an expert's author knows is therefore part of the expert.
"""

from __future__ import annotations

import numpy as np

from coral.contact.scene.trial import PhysicalParameters, Trial

DENSITY_KG_M3, FRICTION = 500.0, 0.5
"""Of something unknown, air inside counted, and on a table: light wood, filled packaging. Orders of magnitude."""


def prior_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """What a robot believes of things that it only sees: the volume of their boxes times one density, one friction."""
    return {
        name: PhysicalParameters(mass_kg=DENSITY_KG_M3 * float(np.prod(trial.size(name))), friction=FRICTION)
        for name in trial.objects
    }


def stated_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """What the author of an expert believes: the middle of the task file's ranges."""
    return {
        item.name: PhysicalParameters(mass_kg=float(np.mean(item.mass_kg)), friction=float(np.mean(item.friction)))
        for item in trial.task.objects
    }
