"""Actions and measurements step by step, and the windows that are informative about an object."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from coral.contact.scene.observation import Observation, Transition

LENGTH, MOST = 12, 14
"""Steps of a window, and the maximum number of windows: few steps, because a rollout of contact diverges from the world
within tenths of a second."""
MOVED_M, FORCE_N = 0.0005, 0.3
"""A window in which the object moved less, and the hand near it felt less, is ignored."""
NEAR_M = 0.25


Window = Sequence[Transition]
"""Consecutive steps."""


def windows(
    steps: Sequence[Transition], name: str, usable: Callable[[Observation], bool] = lambda start: True
) -> list[Window]:
    """Select the windows of a history in which the object was pushed or slid, the most informative ones, in time order.

    A replay begins only at an observation that is usable.
    """
    found = []
    for first in range(0, len(steps) - LENGTH + 1, LENGTH // 2):
        part = steps[first : first + LENGTH]
        if any(abs(b.before.time_s - a.after.time_s) > 1e-6 for a, b in itertools.pairwise(part)) or not usable(
            part[0].before
        ):
            continue
        way = np.array([step.after.objects[name].position - step.before.objects[name].position for step in part])
        moved = float(np.linalg.norm(way, axis=1).sum())
        force = float(np.mean([np.linalg.norm(step.after.wrench[:3]) for step in part]))
        away = [np.linalg.norm(step.after.objects[name].position - step.after.tool.position) for step in part]
        if moved > MOVED_M or (force > FORCE_N and min(away) < NEAR_M):
            found.append((moved + 0.002 * min(force, 5.0), first, part))
    best = sorted(found, key=lambda item: -item[0])[:MOST]
    return [window for _, _, window in sorted(best, key=lambda item: item[1])]


def most_informative_object(steps: Sequence[Transition]) -> str | None:
    """Return the object that moved farthest, or the one nearest to a hand that felt a force; None without any."""
    if not steps:
        return None
    names = list(steps[0].before.objects)
    moved = {
        name: sum(
            float(np.linalg.norm(step.after.objects[name].position - step.before.objects[name].position))
            for step in steps
        )
        for name in names
    }
    name = max(names, key=lambda one: moved[one])
    if moved[name] > 0.003:
        return name
    felt = max(steps, key=lambda step: float(np.linalg.norm(step.after.wrench[:3])))
    if np.linalg.norm(felt.after.wrench[:3]) < 0.5:
        return None
    tool = felt.after.tool.position
    return min(names, key=lambda one: float(np.linalg.norm(felt.after.objects[one].position - tool)))
