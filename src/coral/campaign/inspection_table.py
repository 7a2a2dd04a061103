"""Table of imaging and inspection for every variant: how much, how soon, and compared with which bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coral.campaign.decided import counts
from coral.campaign.measure_tables import means_table
from coral.campaign.measures import Measure, Row, field, mean_interval_text
from coral.campaign.table import Table

BASELINES = ("blind-sweep", "random", "random-unchecked", "oracle")
"""Rows of every table that compares variants, if they ran: blind survey, random choice with and without checks, upper
bound."""

HORIZON_S = 600.0
"""A mission that never inspects 90 % counts with this time, as do those that take longer: without them the mean would
be that of the lucky ones. The same as for the area under the curve."""


def _restricted(row: Row) -> float | None:
    if row.get("inspected") is None:
        return None
    soon = row.get("time_to_90_s")
    return HORIZON_S if soon is None else min(float(soon), HORIZON_S)


def _refused(row: Row) -> float | None:
    answers = counts(row, "answers")
    total = sum(answers.values())
    return 100.0 * answers.get("refused", 0) / total if total else None


INSPECTED = field("inspected", "inspected (%)", "inspected", 100.0)
TIME_TO_90 = field("time_to_90", "to 90 % (s)", "time_to_90_s", digits=0)
RESTRICTED = Measure("time_to_90_restricted", f"to 90 %, at most {HORIZON_S:.0f} s (s)", _restricted, 0)
ORACLE_RATIO = field("oracle_ratio", "× oracle, to 90 %", "oracle_ratio_90", digits=2)
MEASURES = (
    field("imaged", "imaged (%)", "imaged", 100.0),
    INSPECTED,
    field("auc", "area under the curve (%)", "inspected_auc", 100.0),
    field("time_to_50", "to 50 % (s)", "time_to_50_s", digits=0),
    field("time_to_80", "to 80 % (s)", "time_to_80_s", digits=0),
    TIME_TO_90,
    RESTRICTED,
    field("time_to_100", "to 100 % (s)", "time_to_100_s", digits=0),
    ORACLE_RATIO,
    field("own_end", "to its own end (s)", "sim_time_s", digits=0),
    field("all_covered", "to the paper’s coverage (s)", "all_covered_s", digits=0),
    field("idle", "standing still (%)", "idle_fraction", 100.0),
    Measure("refused", "answers refused (%)", _refused),
    field("path_deviations", "deviations of the path", "path_deviations"),
    field("phantoms", "phantom clusters", "phantom_clusters"),
    field("position_error", "position error (m)", "position_error_m", digits=2),
)
NOTES = (
    "Means with 95 % intervals from a seeded bootstrap that draws whole worlds; (28/30): only 28 of 30 missions have "
    "that number. Inspected: mean share of the clusters’ oyster area that the true camera had in its picture at "
    "pixels of 0.05 m or less; imaged: within 6 m. Times and the area, the mean share over the first 600 s, are of "
    f"inspected; at most {HORIZON_S:.0f} s: with {HORIZON_S:.0f} s for missions that never got there.",
    "Random: the whole system with a random advisor; no checks: whatever it draws is driven to. Blind sweep: straight "
    "lanes, through whatever is in the way. Oracle: a tour with the true reef, at cruise speed, without inertia; a "
    "heuristic, not a proven optimum. Oracle and blind sweep continue to their own end; the other missions only with "
    "--cfg.no-stop-when-covered.",
)


def inspection_table(groups: Mapping[str, Sequence[Row]], caption: str, source: tuple[str, ...]) -> Table:
    """Make the table of means per mission; it has no rows if no mission was judged in this way.

    Args:
        groups: Missions by the name of their line.
        caption: Ends the table's caption.
        source: Notes on where the rows come from.
    """
    judged = {name: rows for name, rows in groups.items() if any(row.get("inspected") is not None for row in rows)}
    shown = [m for m in MEASURES if any(m.of(row) is not None for rows in judged.values() for row in rows)]
    what = f"What was inspected, and how soon: means per mission. {caption}"
    return means_table("Inspection", what, "variant", judged, shown, (*NOTES, *source), text=mean_interval_text)
