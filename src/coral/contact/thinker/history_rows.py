"""The history of an attempt in a few rows, as prompts and events show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.contact.scene.observation import Transition
from coral.contact.thinker.plan_note import PlanNote

REPAIR_ROWS = 3
"""Rows of the history in a question for another plan. Departs from the paper: its five rows, which the prompt
`paper` has, leave too little room for the rest in 3,000 tokens, and the evidence is in sentences beside them."""


def recent(
    steps: Sequence[Transition],
    costs: Sequence[tuple[float, float]],
    name: str,
    most: int = 5,
    notes: Sequence[PlanNote] = (),
) -> list[dict[str, Any]]:
    """Summarise the latest history in a few rows, as the prompts show it (the paper's last five steps).

    A row is one control step: metres, newtons, world frame, quaternions (w, x, y, z). Its `touches` name what the
    fingers ("left", "right") and the palm ("hand") touch, as measured; a `cost` of None is unknown.
    """
    if not steps:
        return []
    chosen = np.unique(np.linspace(0, len(steps) - 1, most).astype(int))
    rows: list[dict[str, Any]] = []
    for index in chosen:
        step = steps[int(index)]
        body, before = step.after.objects[name], step.before.objects[name]
        rows.append(
            {
                "time_s": round(step.after.time_s, 2),
                "object_pos": [round(float(v), 4) for v in body.position],
                "object_quat": [round(float(v), 3) for v in body.quaternion],
                "object_moved_mm": round(1e3 * float(np.linalg.norm(body.position - before.position)), 2),
                "hand_pos": [round(float(v), 4) for v in step.after.tool.position],
                "hand_quat": [round(float(v), 3) for v in step.after.tool.quaternion],
                "hand_told_to": [round(float(v), 4) for v in step.command.position],
                "opening_told_m": round(step.command.opening_m, 4),
                "force_on_hand_n": [round(float(v), 2) for v in step.after.wrench[:3]],
                "touches": _touches_at(notes, step.after.time_s),
                "cost": _cost_at(costs, step.before.time_s),
            }
        )
    return rows


def _cost_at(costs: Sequence[tuple[float, float]], time_s: float) -> float | None:
    """Return the cost of the latest plan made by that time."""
    made = [cost for when, cost in costs if when <= time_s + 1e-9] or [cost for _, cost in costs[:1]]
    return round(made[-1], 4) if made else None


def _touches_at(notes: Sequence[PlanNote], time_s: float) -> list[str]:
    """Return what was touched at the latest plan made by that time, as "part on thing"."""
    made = [note for note in notes if note.time_s <= time_s + 1e-9]
    return [f"{part} on {name}" for part, names in made[-1].touched.items() for name in names] if made else []


def recent_terms(notes: Sequence[PlanNote]) -> list[dict[str, Any]]:
    """Show which terms held the cost up at first and at last, the four largest of each."""
    rows = []
    for note in (*notes[:1], *notes[1:][-1:]):
        terms = sorted(note.terms.items(), key=lambda item: -abs(item[1]))[:4]
        shown = {name: float(f"{value:.3g}") for name, value in terms}
        rows.append({"time_s": round(note.time_s, 2), "stage": note.stage, "terms": shown})
    return rows
