"""Prior beliefs about mass and friction, before any answer or measurement. They are defined here and nowhere else.

A robot with an advisor sees shapes only. It does not get the ranges of the task file: the truth is sampled from them,
so their middle would give the answer away. Before the first answer it assumes the same material for everything.

The author of a hand-written cost knows the task file, ranges included, and tunes the cost with them. That knowledge is
therefore part of the expert.
"""

from __future__ import annotations

import numpy as np

from coral.contact.scene.trial import PhysicalParameters, Trial

DENSITY_KG_M3, FRICTION = 500.0, 0.5
"""Density, hollow space included, and friction on a table of an unknown object: light wood, filled packaging."""


def prior_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """Return the beliefs of a robot that sees only shapes: volume of the box times one density, and one friction."""
    return {
        name: PhysicalParameters(mass_kg=DENSITY_KG_M3 * float(np.prod(trial.size(name))), friction=FRICTION)
        for name in trial.objects
    }


def stated_beliefs(trial: Trial) -> dict[str, PhysicalParameters]:
    """Return the beliefs of an expert's author: the middle of the task file's ranges."""
    return {
        item.name: PhysicalParameters(mass_kg=float(np.mean(item.mass_kg)), friction=float(np.mean(item.friction)))
        for item in trial.task.objects
    }
