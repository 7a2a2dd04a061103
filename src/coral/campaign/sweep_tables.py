"""Effect of a sweep on a mission: means for each setting, and paired differences from the nominal one."""

from __future__ import annotations

from collections.abc import Sequence

from coral.campaign.measure_tables import differences_table, means_table
from coral.campaign.measures import Measure, Row, mean_interval_text
from coral.campaign.sweep import NOMINAL, in_order, setting_text
from coral.campaign.table import Table


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
    if not set(settings) - {NOMINAL}:
        return []
    nominal = settings.get(NOMINAL, [])
    changed = {setting: found for setting, found in settings.items() if setting != NOMINAL}
    tables = (
        means_table(
            "Sweep",
            f"Means per mission under each setting. {caption}",
            "setting",
            settings,
            measures,
            (_INTERVALS, *notes),
            text=mean_interval_text,
        ),
        differences_table(
            "Sweep, differences",
            f"Paired differences from the nominal setting. {caption}",
            "setting",
            changed,
            nominal,
            measures,
            (_DIFFERENCES, *notes),
        ),
    )
    return [table for table in tables if table.rows]


_INTERVALS = (
    "One key is changed at a time; nominal: none. 95 % intervals from a seeded bootstrap that draws whole "
    "worlds. (8/9): only 8 of 9 missions have that number."
)
_DIFFERENCES = (
    "Setting minus nominal in the same world with the same seed and advisor; 95 % intervals from the same "
    "bootstrap. ≈: the interval contains zero, so these missions do not distinguish the difference from chance."
)
