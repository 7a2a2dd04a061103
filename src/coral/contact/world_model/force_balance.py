"""Mass and friction from the balance of forces on an object that the hand drags over the table or holds up.

    dragged:   -F . u = mu (m g + F_z) + m a     the table carries the weight and what the hand adds (Coulomb)
    held up:   -F_z   = m (g + a_z)              (Newton)

F is the force on the hand, measured at the wrist; u the direction of the object's motion, a its acceleration. No
rollout is needed, so neither tracking errors of millimetres nor the arm's dynamics change which finger touches what.
The replay then decides whether the history is explained better.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import Array, Transition
from coral.contact.scene.trial import PhysicalParameters, Trial

GRAVITY_M_S2 = 9.81
FINGER_M = np.array([0.010, 0.012, 0.008])
"""Half width of a finger, its thickness, and its extent beyond the tool."""


STEPS = 2
"""Steps per window. A pushed object chatters: it is pushed in one step and slides by itself in the next, so push
and friction balance only over two. Longer windows miss the start and end of a slide."""
REACH = 3
"""Speeds are differences of positions this many steps before and after: a tracker's own speeds lag."""
SLID_M = 0.005
"""An object that moved less than this within that reach was not dragged."""
TURNED_RAD = 0.1
"""An object that turned by more was rotated, not dragged: friction then acts in all directions."""
TOUCH_N = 0.1
"""A window without this much force in any step is ignored."""
FLAT_M = 0.008
"""An object whose lowest point is observed within this distance of the table lies on it."""
LIFTED_M = 0.012
"""An object whose lowest point is observed above this height is held up."""
CLEAR_M = 0.003
STRIKE_N = 3.0
"""A finger closer to the table may strike it: steps with more force are left out then."""
FORCE_N = 0.1
FORCE_SHARE = 0.05
"""Standard deviation of a correct balance's residual: a constant, and a share of the force."""
INERTIA_SHARE = 0.3
"""Share of mass times acceleration in the residual."""
MODEL = 0.03
"""Relative error of the model, which no number of windows reduces."""
LEAST = 2
"""Minimum number of windows for a result."""


@dataclass(frozen=True)
class Balance:
    """Time windows in which the forces on an object balance."""

    dragged: Array
    """Shape=(n, 3): push of the hand along the object's motion (N), F_z (N), acceleration of the object (m/s^2)."""
    held: Array
    """Shape=(k, 2), -F_z (N) and g + a_z (m/s^2)."""

    def __len__(self) -> int:
        return len(self.dragged) + len(self.held)


def balances(steps: Sequence[Transition], name: str, trial: Trial) -> Balance:
    """Find the windows of a history in which the forces balance; they overlap."""
    if len(steps) <= STEPS + 2 * REACH:
        return Balance(np.zeros((0, 3)), np.zeros((0, 2)))
    force = np.array([step.after.wrench[:3] for step in steps])
    place = np.array([step.after.objects[name].position for step in steps])
    turn = np.array([rotation_of(step.after.objects[name].quaternion)[:, 0] for step in steps])
    lowest = np.array([trial.lowest_point(name, step.after.objects[name]) for step in steps])
    lift = np.array([step.after.tool.velocity[2] for step in steps])
    clear = np.array([finger_clearance(trial, step) for step in steps])
    step_s = float(np.median(np.diff([step.after.time_s for step in steps])))
    r, n = REACH, STEPS
    way, turned = np.zeros_like(place), np.ones(len(steps))
    way[r:-r] = place[2 * r :] - place[: -2 * r]
    turned[r:-r] = (turn[2 * r :] * turn[: -2 * r]).sum(axis=1)
    slides = (
        (np.linalg.norm(way[:, :2], axis=1) > SLID_M)
        & (turned > np.cos(TURNED_RAD))
        & (lowest < FLAT_M)
        & ((clear >= CLEAR_M) | (np.abs(force[:, 2]) < STRIKE_N))
    )
    touches = np.linalg.norm(force, axis=1) > TOUCH_N
    dragged, held = [], []
    for first in range(1, len(steps) - n + 1):
        part = slice(first, first + n)
        if not touches[part].any():
            continue
        mean = force[part].mean(axis=0)
        if (lowest[part] > LIFTED_M).all():
            held.append((-mean[2], GRAVITY_M_S2 + (lift[first + n - 1] - lift[first - 1]) / (n * step_s)))
        elif first > r and slides[part].all():
            along = way[part, :2].mean(axis=0)
            along /= np.linalg.norm(along)
            speed = way[[first - 1, first + n - 1], :2] @ along / (2 * r * step_s)
            dragged.append((-mean[:2] @ along, mean[2], (speed[1] - speed[0]) / (n * step_s)))
    return Balance(np.array(dragged, dtype=float).reshape(-1, 3), np.array(held, dtype=float).reshape(-1, 2))


def finger_clearance(trial: Trial, step: Transition) -> float:
    """Return the height (m) of the lowest corner of the fingers over the table; infinite if none is over it."""
    tool = step.after.tool
    size = FINGER_M + np.array([0.0, step.after.opening_m / 2, 0.0])
    corners = size * np.array([[x, y, 1.0] for x in (-1, 1) for y in (-1, 1)]) @ rotation_of(tool.quaternion).T
    corners += tool.position
    table = trial.task.table
    over = (np.abs(corners[:, :2] - table.center) < np.asarray(table.size[:2]) / 2).all(axis=1)
    return float(np.where(over, corners[:, 2], np.inf).min())


def solve_balance(found: Balance, bounds: Array) -> tuple[PhysicalParameters, Array]:
    """Compute the most likely mass and friction, and the covariance of their logarithms, Shape=(2, 2).

    Errors follow a Cauchy distribution: contacts with other things are measured too, and are large. Log mass and log
    friction have `bounds`, Shape=(2, 2).
    """
    axes = [np.linspace(low, high, 160) for low, high in bounds]
    theta = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    cost = np.log1p(np.square(_residuals(theta, found))).sum(axis=1)
    best = theta[int(np.argmin(cost))]
    left, step = _residuals(best[None], found)[0], 1e-3
    slope = np.stack([(_residuals((best + step * unit)[None], found)[0] - left) / step for unit in np.eye(2)])
    # Windows overlap: `STEPS` of them carry the information of one.
    information = (slope / (1.0 + np.square(left))) @ slope.T / STEPS
    covariance = np.linalg.inv(information + 0.01 * np.eye(2)) + MODEL**2 * np.eye(2)
    return PhysicalParameters(float(np.exp(best[0])), float(np.exp(best[1]))), covariance


def balance_error(found: Balance, beliefs: Sequence[PhysicalParameters]) -> Array:
    """Compute the mean of log(1 + r^2) over the windows, r the residual in standard deviations, Shape=(beliefs,)."""
    theta = np.log([[one.mass_kg, one.friction] for one in beliefs])
    return np.asarray(np.log1p(np.square(_residuals(theta, found))).mean(axis=1))


def _residuals(theta: Array, found: Balance) -> Array:
    """Compute the residual of each balance in standard deviations, Shape=(beliefs, windows)."""
    mass, friction = (np.exp(theta[:, k, None]) for k in (0, 1))
    push, press, gain = found.dragged.T
    weight, pull = found.held.T

    def deviation(force: Array, gain: Array) -> Array:
        return np.asarray(FORCE_N + FORCE_SHARE * np.abs(force) + INERTIA_SHARE * mass * np.abs(gain))

    rubbed = (push - friction * (mass * GRAVITY_M_S2 + press) - mass * gain) / deviation(push, gain)
    weighed = (weight - mass * pull) / deviation(weight, pull - GRAVITY_M_S2)
    return np.concatenate([rubbed, weighed], axis=1)
