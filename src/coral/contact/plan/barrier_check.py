"""Check whether coming near an object, or touching it, raises the cost: a penalty gated on a later phase is a barrier.

Only a jump that the planner cannot get over counts: nothing within its reach beyond the jump is cheaper. A smooth
rise is no barrier, since a stand-off may be intended.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from coral.contact.cost.context import Array, Context, Cost
from coral.contact.cost.schema import objects_of
from coral.contact.plan.attraction import DIRECTIONS, STRIDES, Attraction, at_rest, cost_at, descend, total_cost
from coral.contact.scene.geometry import from_rotvec, multiply, rotation_of

SPACING_M = 0.004
"""Distance between the examined places on a ray."""
JUMP = 0.05
"""Rise of the cost at one place that counts as a barrier, relative to its fall on the way there."""
NEAR_M = 0.3
"""A barrier around an object lies at most this far from its surface: a hand begins some 0.2 m away."""
BEYOND_M = 0.12
"""The planner finds its way through a barrier if something within this distance is cheaper."""
EDGE_M = 0.016
"""A barrier begins within this distance of where the descent ended."""
FINE_M = 1e-4
"""A rise that is still there over this distance is a jump."""
BEYOND, CLEAR_M = 160, 0.02
"""Number of places at this distance and more, the cheapest ones, from which a place cheaper than before the jump is
searched."""
CHEAPER = 0.02
"""A place is cheaper if it saves this share of the jump: a descent ends a step short of the jump, and another place as
far from the object must not count as a way through."""
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""The palm pointing down."""
TURNS: tuple[Array, ...] = tuple(
    multiply(from_rotvec(np.array([0.0, 0.0, heading])), tip)
    for tip in (DOWN, multiply(from_rotvec(np.array([0.0, np.pi / 2, 0.0])), DOWN))
    for heading in (0.0, np.pi / 4, np.pi / 2, 3 * np.pi / 4, np.pi, -np.pi / 2)
)
"""Orientations of the hand: the palm down and level, at several headings."""


@dataclass(frozen=True)
class CostFault:
    """One fault of a cost."""

    code: str
    """One of `coral.contact.cost_program.CODES`."""
    line: int
    """Line of the program; 0 if the fault is in no single line."""
    reason: str
    """A sentence for the author of the cost."""
    fatal: bool = True
    """Whether the fault forbids using the cost."""
    stage: str = ""
    """Stage of the plan; "" if the fault is in none, or the cost is alone."""


def gate_barriers(cost: Cost, values: Mapping[str, Any], attraction: Attraction) -> list[CostFault]:
    """Return faults for penalties that begin near an object and keep the hand away from it (the second pitfall)."""
    least = JUMP * attraction.span
    if least <= 0.0:
        return []
    met: dict[str, list[tuple[float, Array]]] = {}
    for end, reached in zip(attraction.ends, attraction.reached, strict=True):
        wall = _wall_around(cost, dict(values), end, float(reached), least)
        if wall is not None:
            before, after, rise = wall
            name, _ = nearest_object(values, after)
            met.setdefault(name, []).append((rise, before))
    faults = []
    for name, walls in met.items():
        if 2 * len(walls) < len(attraction.ends):
            continue
        rise, before = sorted(walls, key=lambda wall: wall[0])[len(walls) // 2]
        _, distance = nearest_object(values, before)
        reason = (
            f"the cost leads the hand towards the {name} and jumps up by {rise:.3g} when it is "
            f"{max(distance, 0.0):.2f} m away, and nothing nearer is cheaper, so the hand stays outside; subtract "
            "a bonus for what you want there instead"
        )
        faults.append(CostFault("barrier", 0, reason))
    return faults


def _wall_around(
    cost: Cost, values: dict[str, Any], end: Array, reached: float, least: float
) -> tuple[Array, Array, float] | None:
    """Return the places before and after a jump of the cost next to the end of a descent, and the rise; or None."""
    away = SPACING_M * np.arange(1, round(BEYOND_M / SPACING_M) + 1)
    rays = end + away[None, :, None] * DIRECTIONS[:, None, :]
    found = cost_at(cost, values, rays.reshape(-1, 3)).reshape(rays.shape[:2])
    path = np.concatenate([np.full((len(found), 1), reached), found], axis=1)
    near = round(EDGE_M / SPACING_M)
    rises = np.diff(path[:, : near + 1], axis=1)
    cheaper = reached - max(0.1 * least, CHEAPER * float(rises.max()))
    if found.min() < cheaper:
        return None
    for ray, step in np.argwhere(rises >= least):
        begin = end + step * SPACING_M * DIRECTIONS[ray]
        if nearest_object(values, begin)[1] > NEAR_M or not _goes_to_object(values, begin, DIRECTIONS[ray]):
            continue
        fine = begin + np.arange(0.0, SPACING_M + FINE_M, FINE_M)[:, None] * DIRECTIONS[ray]
        change = np.diff(cost_at(cost, values, fine))
        at = int(change.argmax())
        if change[at] >= 0.5 * rises[ray, step] and _stands_when_turned(cost, values, fine[at], fine[at + 1], least):
            deep = away >= CLEAR_M
            order = np.argsort(found[:, deep].ravel(), kind="stable")[:BEYOND]
            lowest = descend(cost, values, rays[:, deep].reshape(-1, 3)[order], STRIDES[1:])[2].min()
            return None if lowest < cheaper else (fine[at], fine[at + 1], float(change[at]))
    return None


def _stands_when_turned(cost: Cost, values: dict[str, Any], before: Array, after: Array, least: float) -> bool:
    """Check whether a jump is there however the hand is turned: a penalty on a bad alignment is none."""
    turned = [{**values, "ee_quat": turn[None, None]} for turn in TURNS] if "ee_quat" in values else [values]
    both = np.stack([before, after])
    return all(float(np.diff(cost_at(cost, one, both))[0]) >= least for one in turned)


def _goes_to_object(values: Mapping[str, Any], point: Array, direction: Array) -> bool:
    name, _ = nearest_object(values, point)
    return bool(name) and float((values[f"{name}_pos"][0, 0] - point) @ direction) > 0.0


def nearest_object(values: Mapping[str, Any], point: Array) -> tuple[str, float]:
    """Return the movable object whose bounding box is nearest to a point, and its distance (m); negative inside."""
    found = []
    for name in objects_of(values):
        size = values[f"{name}_size"][0, 0] if f"{name}_size" in values else np.zeros(3)
        local = np.abs(rotation_of(values[f"{name}_quat"][0, 0]).T @ (point - values[f"{name}_pos"][0, 0])) - size / 2
        outside = float(np.linalg.norm(np.maximum(local, 0.0)))
        found.append((outside if outside > 0.0 else float(local.max()), name))
    return (min(found)[1], min(found)[0]) if found else ("", np.inf)


def touch_barriers(cost: Cost, pool: Context, attraction: Attraction) -> list[CostFault]:
    """Return faults for costs that begin to count something else once the hand touches what it is led to.

    A constant penalty on the touch is none: a stage may forbid it.

    `pool` holds various states, Shape=(n, 1); `attraction` is where the cost leads the hand as the stage begins.
    """
    faults = []
    values: dict[str, Any] = {name: pool.source(name) for name in pool.names()}
    first = at_rest(pool)
    for thing in objects_of(values):
        flags = [name for part in ("hand", "left", "right") if (name := f"{thing}_{part}_contact") in values]
        led = [
            nearest_object(first, end)[0] == thing and nearest_object(first, end)[1] < 0.005 for end in attraction.ends
        ]
        if not flags or 2 * sum(led) < len(led):
            continue
        free = np.flatnonzero(np.all([values[name][:, 0] == 0 for name in flags], axis=0))
        if len(free) < 4:
            continue
        apart = {
            name: value[free] if isinstance(value, np.ndarray) and len(value) == len(values["ee_pos"]) else value
            for name, value in values.items()
        }
        shape = (len(free), 1)
        touching = {**apart, **{name: np.ones(shape) for name in flags}}
        after, before = (total_cost(cost(Context(one, shape)), shape)[:, 0] for one in (touching, apart))
        rise = after - before
        if np.median(rise) <= 0.5 * attraction.span or np.ptp(rise) <= 1e-9:
            continue
        reason = (
            f"the cost leads the hand to the {thing} and rises by {np.median(rise):.3g} when "
            "it touches it, more than the way there gains, so the hand stays away; let what begins there count "
            "before the touch too, or subtract a larger bonus for it"
        )
        faults.append(CostFault("barrier", 0, reason))
    return faults
