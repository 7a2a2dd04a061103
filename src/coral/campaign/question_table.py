"""Table of the questions of every variant: could they be answered, were answers late, did the vehicle wait?"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from coral.campaign.decided import counts
from coral.campaign.measures import Row, field, mean_text
from coral.campaign.table import Table

IDLE = field("idle", "standing still (%)", "idle_fraction", 100.0)
THINKING = field("thinking", "advisor thinking (s)", "thinking_s", digits=0)
HEADER = (
    "variant",
    "missions",
    "questions",
    "without an acceptable choice",
    "answers",
    "refused (%)",
    "refused late, at most (%)",
    "overtaken (%)",
    IDLE.label,
    THINKING.label,
)
LATE = ("refused_late", "overtaken")
NOTES = (
    "Counts are sums over the missions, standing still and thinking are means. Refused late: for an obstacle or "
    "another robot that the map showed when the answer came; at most this many became impossible while waiting. "
    "Overtaken: chosen clusters that the robot had seen from near by then.",
)


def question_table(
    by_variant: Mapping[str, Sequence[Row]], name: Callable[[str], str], caption: str, source: tuple[str, ...]
) -> Table:
    """Make the table; variants that ask nothing have no row."""
    lines = []
    for variant, rows in by_variant.items():
        asked = [row for row in rows if row.get("unanswerable") is not None and row.get("advisor_calls")]
        if not asked:
            continue
        fates = [counts(row, "answers") for row in asked]
        answers = sum(sum(fate.values()) for fate in fates)
        refused = sum(fate.get("refused", 0) for fate in fates)
        lines.append(
            (
                name(variant),
                str(len(asked)),
                str(_total(asked, "advisor_calls")),
                str(_total(asked, "unanswerable")),
                str(answers),
                *(_percent(part, answers) for part in (refused, *(_total(asked, k) for k in LATE))),
                mean_text(asked, IDLE),
                mean_text(asked, THINKING),
            )
        )
    return Table(
        "Questions", f"Could they be answered, and in time? {caption}", HEADER, tuple(lines), (*NOTES, *source)
    )


def _total(rows: Sequence[Row], key: str) -> int:
    return sum(int(row.get(key) or 0) for row in rows)


def _percent(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f}" if whole else "—"
