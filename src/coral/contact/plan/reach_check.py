"""Check whether the hand can reach the targets of a cost.

The distances that a program computes are compared with and without a small shift of the hand: those that change with it
are distances of the hand to some target, however the program computed them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coral.contact.cost.context import Array, Context, Terms
from coral.contact.cost_program.state import objects_of
from coral.contact.cost_program.trace import Distance
from coral.contact.plan.cost_fault import CostCheckCfg, CostFault, Traceable

SHIFT = np.array([0.011, -0.017, 0.013])
"""A shift of the hand, m; its components differ so that they can be told apart."""


MOST = 24
"""Maximum number of distances examined, so that a program with many of them does not delay the planner."""


@dataclass(frozen=True, eq=False)
class ReachTerm:
    """A distance from the hand to a target that raises the cost."""

    index: int
    """Number of the distance in the trace."""
    line: int
    """Line of the program."""
    target: Array
    """Target position of the hand, Shape=(n, 3), m."""
    value: Array
    """Distance, Shape=(n,), m."""
    saved: Array
    """Decrease of the cost if the distance were 0, Shape=(n,)."""


def with_quantities(state: Context, values: Mapping[str, Array], shape: tuple[int, int] | None = None) -> Context:
    """Return the batch with some quantities replaced."""
    return Context({**{name: state[name] for name in state.names()}, **values}, shape or state.shape)


def total_cost(terms: Terms) -> Array:
    """Sum the terms of every state."""
    total: Array = np.sum([np.asarray(term) for term in terms.values()], axis=0)
    return total


def find_reach_terms(cost: Traceable, pool: Context) -> list[ReachTerm]:
    """Find the distances from the hand to a target that raise the cost.

    Args:
        cost: The cost.
        pool: States, Shape=(n, 1).

    Raises:
        CostError: The cost cannot be evaluated.
    """
    base = cost.trace(pool)
    hand = np.asarray(pool["ee_pos"])
    moved = cost.trace(with_quantities(pool, {"ee_pos": hand + SHIFT}))
    if len(moved.distances) != len(base.distances):
        return []
    total = total_cost(base.terms)
    reach_terms: list[ReachTerm] = []
    for index, (before, after) in enumerate(zip(base.distances, moved.distances, strict=True)):
        target = _target(before, after, hand[:, 0, :])
        if target is None or len(reach_terms) >= MOST:
            continue
        saved = total - total_cost(cost.trace(pool, zeroed=index).terms)
        value = np.broadcast_to(before.value, total.shape)[:, 0]
        if np.median(saved) > 1e-9 * (1.0 + np.abs(total).max()):
            reach_terms.append(ReachTerm(index, before.line, target, value, saved[:, 0]))
    return reach_terms


def _target(before: Distance, after: Distance, hand: Array) -> Array | None:
    """Return the position of the other end of a distance, Shape=(n, 3); None if the hand is at neither end."""
    size = len(before.vector)
    if size not in (2, 3):
        return None
    moves = [np.broadcast_to(b - a, (len(hand), 1))[:, 0] for a, b in zip(before.vector, after.vector, strict=True)]
    for sign in (1.0, -1.0):
        if all(np.allclose(move, sign * SHIFT[i], rtol=0, atol=1e-9) for i, move in enumerate(moves)):
            vector = np.stack([np.broadcast_to(part, (len(hand), 1))[:, 0] for part in before.vector], axis=-1)
            target = hand.copy()
            target[:, :size] -= sign * vector
            return target
    return None


def unreachable(cost: Traceable, pool: Context, reach_terms: list[ReachTerm], cfg: CostCheckCfg) -> list[CostFault]:
    """Return faults for targets from which a solid keeps the hand away (the first pitfall)."""
    faults, lines = [], set()
    for item in reach_terms:
        if item.line in lines:
            continue
        reason = _inside_fault(pool, item, cfg) or _contact_fault(pool, item, cfg)
        if reason:
            lines.add(item.line)
            faults.append(CostFault("unreachable", item.line, f"line {item.line} (`{cost.line(item.line)}`): {reason}"))
    return faults


def _inside_fault(pool: Context, item: ReachTerm, cfg: CostCheckCfg) -> str:
    """Check whether the target lies inside an object too wide for the fingers to straddle."""
    for thing in objects_of(pool.names()):
        names = [f"{thing}_pos", f"{thing}_quat", f"{thing}_size"]
        if not all(name in pool for name in names):
            continue
        centre, quat, size = (np.asarray(pool[name])[:, 0, :] for name in names)
        offset = np.einsum("nji,nj->ni", rotations(quat), item.target - centre)
        depth = (size / 2.0 - np.abs(offset)).min(axis=1)
        if size.min() > cfg.opening_m and np.median(depth) > cfg.reach_m and np.median(item.saved) > 0.0:
            return (
                f"the target lies {np.median(depth):.3f} m inside the {thing}, which is too wide for the fingers "
                f"to straddle, so this distance cannot come near 0; aim at a point on the surface of the {thing}"
            )
    return ""


def _contact_fault(pool: Context, item: ReachTerm, cfg: CostCheckCfg) -> str:
    """Check whether, in the closest states, a contact pushes the hand away from the target."""
    closest = np.argsort(item.value, kind="stable")[: max(8, len(item.value) // 50)]
    least = float(item.value[closest[0]])
    if not cfg.reach_m < least < cfg.near_m or "ee_force" not in pool:
        return ""
    force = np.asarray(pool["ee_force"])[closest, 0, :]
    towards = item.target[closest] - np.asarray(pool["ee_pos"])[closest, 0, :]
    size = np.linalg.norm(force, axis=-1)
    against = (force * towards).sum(axis=-1) / (size * np.linalg.norm(towards, axis=-1) + 1e-12)
    stopped = (size > cfg.force_n) & (against < -0.3)
    saved = item.saved[closest]
    if stopped.mean() < 0.5 or np.median(saved) <= 1e-9 * (1.0 + np.abs(item.saved).max()):
        return ""
    return (
        f"this distance cannot come below {least:.3f} m: in the closest sampled states something solid pushes "
        f"the hand back; aim at a point the fingertips can get to, or use max(0.0, distance - {least + 0.005:.2f})"
    )


def rotations(quat: Array) -> Array:
    """Compute the rotation matrices of unit quaternions.

    Args:
        quat: Shape=(n, 4), (w, x, y, z).

    Returns:
        Shape=(n, 3, 3).
    """
    w, x, y, z = (quat / np.linalg.norm(quat, axis=-1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
