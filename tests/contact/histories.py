"""Histories written by hand: where things were, what the hand felt and what it was told, step by step."""

import itertools

import numpy as np

from coral.contact.scene.observation import BodyState, HandTarget, Observation, Transition

TOOL = (0.0, 0.0, 0.3)
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def history(steps, *, tool=TOOL, told=None, force=(0.0, 0.0, 0.0), period_s=0.02, start_s=0.0, **objects):
    """A history of so many control steps.

    Args:
        steps: How many.
        tool: Where the hand is, one place or a function of the step.
        told: Where it is told to be, likewise; by default where it is.
        force: On the hand, N, likewise.
        period_s: Of control.
        start_s: Time at which it begins.
        objects: Where each object is, m, likewise.
    """

    def at(value, k):
        return np.array(value(k) if callable(value) else value, dtype=float)

    seen = [
        Observation(
            start_s + period_s * k,
            BodyState(at(tool, k), DOWN),
            0.08,
            np.array([*at(force, k), 0.0, 0.0, 0.0]),
            {name: BodyState(at(place, k), UPRIGHT) for name, place in objects.items()},
        )
        for k in range(steps + 1)
    ]
    return [
        Transition(before, HandTarget(at(tool if told is None else told, k), DOWN, 0.08, 600.0), after)
        for k, (before, after) in enumerate(itertools.pairwise(seen))
    ]


def sliding(mm_per_step, start=(0.0, 0.0, 0.03)):
    """A place that moves along x with each step."""
    return lambda k: np.array(start) + np.array([0.001 * mm_per_step * k, 0.0, 0.0])
