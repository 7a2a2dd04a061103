"""Effect of a sweep on a mission: means for each setting, and paired differences from the nominal one."""

from __future__ import annotations

from collections.abc import Sequence

from coral.campaign.decided import marked
from coral.campaign.measures import Measure, Row, difference, difference_text, mean_interval_text, pair
from coral.campaign.sweep import NOMINAL, in_order, setting_text
from coral.campaign.table import Table

FEW_WORLDS = 6
"""With fewer worlds a bootstrap has too few different samples: three worlds make ten."""


def by_setting(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Group rows by setting, the nominal one first."""
    found: dict[str, list[Row]] = {setting_text(text): [] for text in in_order(row["overrides"] for row in rows)}
    for row in rows:
        found[setting_text(row["overrides"])].append(row)
    return found


def sweep_tables(rows: Sequence[Row], measures: Sequence[Measure], caption: str, notes: tuple[str, ...]) -> list[Table]:
    """Make two tables of one variant's missions under one advisor; none if nothing was swept.

    Args:
        rows: Finished missions of every setting.
        measures: Measures in the order of the columns.
        caption: Variant and advisor.
        notes: Source of the numbers.
    """
    settings = by_setting(rows)
    worlds = len({row["world"] for row in rows})
    if worlds < FEW_WORLDS:
        notes = (f"Few worlds to draw from ({worlds}): these intervals are narrower than they should be.", *notes)
    if not set(settings) - {NOMINAL}:
        return []
    labels = [measure.label for measure in measures]
    means = [
        (marked(setting, found), str(len(found)), *(mean_interval_text(found, measure) for measure in measures))
        for setting, found in settings.items()
    ]
    tables = [
        Table(
            "Sweep",
            f"Means per mission under each setting. {caption}",
            ("setting", "missions", *labels),
            tuple(means),
            (_INTERVALS, *notes),
        )
    ]
    nominal = settings.pop(NOMINAL, [])
    if nominal:
        lines, silent = [], []
        for setting, found in settings.items():
            estimates = [difference(found, nominal, measure) for measure in measures]
            pairs = len({pair(row) for row in found} & {pair(row) for row in nominal})
            lines.append(
                (
                    marked(setting, found),
                    str(pairs),
                    *(difference_text(e, m.digits) for e, m in zip(estimates, measures, strict=True)),
                )
            )
            if not any(estimate.tells for estimate in estimates):
                silent.append(setting)
        more = (f"No difference in any of these numbers could be shown for: {', '.join(silent)}.",) if silent else ()
        tables.append(
            Table(
                "Sweep, differences",
                f"Paired differences from the nominal setting. {caption}",
                ("setting", "pairs", *(f"Δ {label}" for label in labels)),
                tuple(lines),
                (_DIFFERENCES, *more, *notes),
            )
        )
    return tables


_INTERVALS = (
    "One key is changed at a time; nominal: none. 95 % intervals from a seeded bootstrap that draws whole "
    "worlds. (8/9): only 8 of 9 missions have that number."
)
_DIFFERENCES = (
    "Setting minus nominal in the same world with the same seed and advisor; 95 % intervals from the same "
    "bootstrap. ≈: the interval contains zero, so these missions do not distinguish the difference from chance."
)
