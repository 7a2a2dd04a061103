"""The prompt of a repair: what it says of the plan that failed, and less of it if the scene itself is long.

The history of an attempt is told in a few rows, in prompts and in events.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coral.advisor.prompt import render
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.scene.observation import Transition
from coral.contact.thinker.diagnosis import TEXTS, Diagnosis
from coral.contact.thinker.progress_monitor import PlanNote, ProgressMonitor

MOST_CHARACTERS = 9_200
"""Characters of a repair's prompt without its author's program: under 3,000 tokens.."""
SHORTENED = (("earlier", 1), ("history", 2), ("terms", 1), ("earlier", 0), ("history", 1))
"""What is shortened, in this order, and to how many rows."""
REPAIR_ROWS = 3
"""Rows of the history in a question for another plan. Departs from the paper: its five rows, which the prompt
`paper` has, leave too little room for the rest in 3,000 tokens, and the evidence is in sentences beside them."""


def repair_values(
    plan: PlanAnswer,
    regions: RegionsAnswer | None,
    monitor: ProgressMonitor,
    name: str,
    diagnoses: Sequence[Diagnosis],
    *,
    evidence: Sequence[str] = (),
    corrected: Sequence[str] = (),
    advice: Sequence[str] = (),
    error: str = "",
    bare: bool = False,
) -> dict[str, Any]:
    """Return the placeholders that tell of a plan that failed; the last of the diagnoses is of this plan.

    `evidence` is the record in sentences, `corrected` tells of masses and frictions, `advice` is what the plan's check
    noted without refusing it, `error` why it could not be evaluated. `bare` tells only the last five steps and what
    they cost, as the paper does (A.9): its model diagnoses.
    """
    rows = recent(monitor.steps, monitor.costs, name, 5 if bare else REPAIR_ROWS, monitor.notes)
    if bare:
        diagnoses, evidence, corrected, advice, regions = (), (), (), (), None
    return {
        "attempts": monitor.attempts,
        "stage": "" if bare else monitor.stage,
        "object": name,
        "diagnosis": f"Diagnosis: {TEXTS[diagnoses[-1]]}." if diagnoses else "",
        "earlier": [TEXTS[diagnosis] for diagnosis in diagnoses[:-1]],
        "evidence": list(evidence),
        "corrected": list(corrected),
        "advice": list(advice),
        "history": [{"object_pos": row["object_pos"], "cost": row["cost"]} for row in rows] if bare else rows,
        "terms": [] if bare else recent_terms(monitor.notes),
        "regions": [] if regions is None else regions.lines(),
        "code": plan.text(numbered=True),
        "explanation": plan.explanation,
        "error": error,
    }


def fit_prompt(kind: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out rows of the history until the prompt is short enough, or until the fewest rows are left.

    The first and the last row tell what changed, so the middle ones go first.
    """
    fitted = {**values, **{key: list(values[key]) for key, _ in SHORTENED}}
    for key, least in SHORTENED:
        rows = fitted[key]
        while len(rows) > least and len(render(kind, {**fitted, "code": "-"})[0]) > MOST_CHARACTERS:
            del rows[(len(rows) - 1) // 2]
    return fitted


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
