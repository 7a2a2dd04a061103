"""The cost terms of DDP-MPPI: what each measures on a rollout, its scale and its weight (paper IV-F, Alg. 3).

A new term is a name in `COSTS`, a weight in `CostCfg`, and its lines in the two kernels; nothing else lists the terms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.config import Positive

Array = NDArray[np.float64]

COSTS = ("goal", "obstacle", "speed", "path", "heading", "smooth")
GOAL, OBSTACLE, SPEED, PATH, HEADING, SMOOTH = range(len(COSTS))


@dataclass(frozen=True, kw_only=True)
class CostCfg:
    """Weights of the cost terms. Each term has a fixed scale, so lambda means the same at every tick."""

    goal: float = 0.6
    """Mean of the cost-to-go at the end and along the rollout, minus its present value, divided by the longest rollout
    (-1: full progress, 0: none). Paper IV-F."""
    obstacle: float = 0.5
    """Mean over time of ((1 - clearance / soft_m)+)^2. Paper IV-F."""
    speed: float = 0.3
    """Mean of 1 - u / v_max. Paper IV-F."""
    path: float = 0.0
    """(Metres driven + cost-to-go at the end - cost-to-go now) / longest rollout: metres without progress. Alg. 3 names
    this term, but the paper gives no weight. 0, since the cost-to-go already penalises detours."""
    heading: float = 0.2
    """Mean of (1 - cos) / 2 of the angle between the heading and the descent of the cost-to-go. Departs from the
    paper: the camera looks forward and the vehicle drives only forward, so a goal behind it needs a turn first."""
    smooth: float = 0.05
    """Mean squared change of the command, in units of its limits. Departs from the paper: it names smoothness in III-E,
    but not in Alg. 3, and gives no weight."""
    soft_m: Positive = 0.4
    """Clearance of the hull below which proximity has a cost."""

    @property
    def weights(self) -> Array:
        """The weights in the order of `COSTS`."""
        return np.array([getattr(self, name) for name in COSTS])


class Scales(NamedTuple):
    """What the terms are measured in."""

    soft_m: float
    body_m: float
    """Radius of the hull, from which proximity is measured."""
    reach_m: float
    """Length of the longest possible rollout."""
    speed_m_s: float
    """Largest forward speed."""
    yaw_rate_rad_s: float
    """Largest yaw rate."""


class Step(NamedTuple):
    """The end of one step of a rollout."""

    dt: float
    """Interval of the step (s)."""
    speed_m_s: float
    """Forward speed of the vehicle."""
    cos: float
    sin: float
    """Of its heading."""
    value: float
    """Cost-to-go (m)."""
    gradient_x: float
    gradient_y: float
    """Gradient of the cost-to-go."""
    nearest_m: float
    """Smallest distance from the vehicle's centre to an obstacle during the step."""
    command_change: float
    """Squared change of the command since the step before, in units of its limits."""


@njit(cache=True, error_model="numpy")
def add_step(sums: Array, step: Step, scales: Scales) -> None:
    """Add one step of a rollout to the sums of its terms. Shape=(len(COSTS),), zero before the first."""
    sums[GOAL] += step.value * step.dt
    tight = max(0.0, 1.0 - (step.nearest_m - scales.body_m) / scales.soft_m)
    sums[OBSTACLE] += tight * tight * step.dt
    # Within a metre of the goal, speed and heading no longer matter.
    far = min(1.0, step.value) * step.dt
    sums[SPEED] += max(0.0, 1.0 - max(step.speed_m_s, 0.0) / scales.speed_m_s) * far
    slope = math.sqrt(step.gradient_x * step.gradient_x + step.gradient_y * step.gradient_y)
    if slope > 1e-9:
        sums[HEADING] += 0.5 * (1.0 + (step.gradient_x * step.cos + step.gradient_y * step.sin) / slope) * far
    sums[SMOOTH] += step.command_change


@njit(cache=True, error_model="numpy")
def finish(
    sums: Array, horizon_s: float, n_steps: int, driven_m: float, end: float, now: float, scales: Scales
) -> None:
    """Turn a rollout's sums into its normalised terms, in place; `end` and `now` are the cost-to-go then (m)."""
    sums[GOAL] = (0.5 * (end + sums[GOAL] / horizon_s) - now) / scales.reach_m
    sums[OBSTACLE] /= horizon_s
    sums[SPEED] /= horizon_s
    sums[PATH] = (driven_m + end - now) / scales.reach_m
    sums[HEADING] /= horizon_s
    sums[SMOOTH] /= n_steps
