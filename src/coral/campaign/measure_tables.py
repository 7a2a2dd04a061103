"""Two tables of measures over groups of missions: their means, and paired differences from a reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from coral.campaign.decided import marked
from coral.campaign.measures import Measure, Row, difference, difference_text, mean_text, pair
from coral.campaign.table import Table

Groups = Mapping[str, Sequence[Row]]
"""Missions by the name of their line."""


def means_table(
    label: str,
    caption: str,
    by: str,
    groups: Groups,
    measures: Sequence[Measure],
    notes: tuple[str, ...],
    *,
    text: Callable[[Sequence[Row], Measure], str] = mean_text,
) -> Table:
    """Make a table with a line for each group that has missions; `by` says what a group is, such as "variant"."""
    return Table(
        label,
        caption,
        (by, "missions", *(measure.label for measure in measures)),
        tuple(
            (marked(name, rows), str(len(rows)), *(text(rows, measure) for measure in measures))
            for name, rows in groups.items()
            if rows
        ),
        notes,
    )


def differences_table(
    label: str,
    caption: str,
    by: str,
    groups: Groups,
    reference: Sequence[Row],
    measures: Sequence[Measure],
    notes: tuple[str, ...],
) -> Table:
    """Make a table of each group minus the reference, with intervals; without a reference it has no rows.

    A note after the first, which says what a difference is, names the groups without any that could be shown.
    """
    lines, silent = [], []
    for name, rows in groups.items() if reference else ():
        if not rows:
            continue
        estimates = [difference(rows, reference, measure) for measure in measures]
        pairs = len({pair(row) for row in rows} & {pair(row) for row in reference})
        texts = (difference_text(e, m.digits) for e, m in zip(estimates, measures, strict=True))
        lines.append((marked(name, rows), str(pairs), *texts))
        if not any(estimate.tells for estimate in estimates):
            silent.append(name)
    more = (f"No difference in any of these numbers could be shown for: {', '.join(silent)}.",) if silent else ()
    header = (by, "pairs", *(f"Δ {measure.label}" for measure in measures))
    return Table(label, caption, header, tuple(lines), (notes[0], *more, *notes[1:]))
