"""The prompt of a repair: what it says of the plan that failed, and less of it if the scene itself is long."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from coral.advisor.prompt import render
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker.diagnosis import TEXTS, Diagnosis
from coral.contact.thinker.history_rows import REPAIR_ROWS, recent, recent_terms
from coral.contact.thinker.progress_monitor import ProgressMonitor

MOST_CHARACTERS = 9_200
"""Characters of a repair's prompt without its author's program: under 3,000 tokens.."""
SHORTENED = (("earlier", 1), ("history", 2), ("terms", 1), ("earlier", 0), ("history", 1))
"""What is shortened, in this order, and to how many rows."""


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
