"""Check whether approaching or touching an object raises the cost: the barrier of a penalty gated on a later phase."""

from __future__ import annotations

import numpy as np

from coral.contact.cost.context import Array, Context, Terms
from coral.contact.cost_program.state import objects_of
from coral.contact.plan.cost_fault import CostCheckCfg, CostFault, Traceable
from coral.contact.plan.reach_check import ReachTerm, total_cost, with_quantities

STEPS = 33
FAR_M = 0.12
"""Approaches begin at least this far away, so that a gate near the target lies in their second half."""


def path_barriers(cost: Traceable, pool: Context, reach_terms: list[ReachTerm], cfg: CostCheckCfg) -> list[CostFault]:
    """Return faults for terms that start near a target and rise there (the second pitfall).

    The hand is moved in a straight line to each target to which the cost attracts it; everything else stays as it is.
    """
    faults, named = [], set()
    for item in reach_terms:
        terms = _along_path(cost, pool, item, cfg)
        if terms is None:
            continue
        total = total_cost(terms)
        climb = (total - np.minimum.accumulate(total, axis=1)).max(axis=1)
        if np.median(climb) <= cfg.rise * np.median(np.ptp(total, axis=1)) + 1e-9:
            continue
        for name, term in terms.items():
            rise = _gated_rise(np.asarray(term))
            if np.median(rise) >= 0.5 * np.median(climb) and name not in named:
                named.add(name)
                line = cost.term_line(name) or item.line
                faults.append(
                    CostFault(
                        "barrier",
                        line,
                        f"line {line} (`{cost.line(line)}`): the term {name!r} begins only "
                        f"when the hand is near its target and adds up to {np.median(rise):.3g} there, so "
                        "coming near gets dearer; subtract a bonus for what you want there instead",
                    )
                )
        if len(terms) == 1 and len(reach_terms) == 1 and not faults:
            line = item.line
            faults.append(
                CostFault(
                    "barrier",
                    line,
                    f"line {line} (`{cost.line(line)}`): the cost rises by "
                    f"{np.median(climb):.3g} when the hand comes near the target of this distance; write "
                    "what begins there as a bonus that is subtracted",
                )
            )
    return faults


def _along_path(cost: Traceable, pool: Context, item: ReachTerm, cfg: CostCheckCfg) -> Terms | None:
    """Evaluate the terms on straight approaches of the hand to the target, each Shape=(paths, STEPS)."""
    start = np.asarray(pool["ee_pos"])[:, 0, :]
    far = np.linalg.norm(item.target - start, axis=-1)
    chosen = np.flatnonzero(far > FAR_M)
    if not len(chosen):
        return None
    chosen = chosen[np.unique(np.linspace(0, len(chosen) - 1, cfg.paths).astype(int))]
    values = {name: np.asarray(pool[name])[chosen] for name in pool.names()}
    share = np.linspace(0.0, 1.0, STEPS)[None, :, None]
    values["ee_pos"] = (1.0 - share) * start[chosen, None, :] + share * item.target[chosen, None, :]
    for name in values:
        if name.endswith(("_hand_contact", "_left_contact", "_right_contact")) or name in ("ee_force", "ee_torque"):
            values[name] = np.zeros_like(values[name])
    terms = cost.trace(Context(values, (len(chosen), STEPS))).terms
    return {name: np.broadcast_to(term, (len(chosen), STEPS)) for name, term in terms.items()}


def _gated_rise(term: Array) -> Array:
    """Compute how much a term that starts flat rises later, Shape=(paths,); 0 for a term that does not start flat."""
    half = STEPS // 2
    span = np.ptp(term, axis=1)
    flat = np.ptp(term[:, :half], axis=1) <= 0.1 * span
    rise = term[:, half:].max(axis=1) - term[:, 0]
    return np.where(flat, np.maximum(rise, 0.0), 0.0)


def contact_barriers(
    cost: Traceable, pool: Context, reach_terms: list[ReachTerm], cfg: CostCheckCfg
) -> list[CostFault]:
    """Return faults for terms that raise the cost once the hand touches an object to which the cost attracts it."""
    faults = []
    for thing in objects_of(pool.names()):
        flags = [f"{thing}_{part}_contact" for part in ("hand", "left", "right") if f"{thing}_{part}_contact" in pool]
        if not flags or not _is_target(pool, thing, reach_terms):
            continue
        free = np.flatnonzero(np.all([np.asarray(pool[name])[:, 0] == 0 for name in flags], axis=0))
        if len(free) < 4:
            continue
        values = {name: np.asarray(pool[name])[free] for name in pool.names()}
        apart = Context(values, (len(free), 1))
        touching = with_quantities(apart, {name: np.ones((len(free), 1)) for name in flags})
        before, after = cost.trace(apart).terms, cost.trace(touching).terms
        rise = np.median(total_cost(after) - total_cost(before))
        if rise <= cfg.rise * np.ptp(total_cost(before)) + 1e-9:
            continue
        for name, term in after.items():
            begun = np.asarray(term)
            if (
                np.abs(before.get(name, np.zeros(1))).max() <= 1e-12
                and np.median(begun) >= 0.5 * rise
                and np.ptp(begun) > 1e-9
            ):
                line = cost.term_line(name)
                faults.append(
                    CostFault(
                        "barrier",
                        line,
                        f"line {line} (`{cost.line(line)}`): the term {name!r} begins when "
                        f"the hand touches the {thing} and adds {np.median(begun):.3g}, so touching gets "
                        "dearer; let it count before the touch too, or subtract a larger bonus for it",
                    )
                )
    return faults


def _is_target(pool: Context, thing: str, reach_terms: list[ReachTerm]) -> bool:
    """Check whether a distance that raises the cost ends at the object."""
    centre = np.asarray(pool[f"{thing}_pos"])[:, 0, :]
    size = np.asarray(pool[f"{thing}_size"])[:, 0, :] if f"{thing}_size" in pool else np.full_like(centre, 0.1)
    return any(
        np.median(np.linalg.norm(item.target - centre, axis=-1) - np.linalg.norm(size, axis=-1) / 2) < 0.05
        for item in reach_terms
    )
