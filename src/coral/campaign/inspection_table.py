"""Table of imaging and inspection for every variant: how much, how soon, and compared with which bound."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from coral.campaign.measure_tables import means_table
from coral.campaign.measures import Measure, Row, field
from coral.campaign.table import Table

BASELINES = ("blind-sweep", "random", "random-unchecked", "oracle")
"""Rows of every table that compares variants, if they ran: blind survey, random choice with and without checks, upper
bound."""

INSPECTED = field("inspected", "inspected (%)", "inspected", 100.0)
TIME_TO_90 = field("time_to_90", "to 90 % (s)", "time_to_90_s", digits=0)
ORACLE_RATIO = field("oracle_ratio", "× oracle, to 90 %", "oracle_ratio_90", digits=2)
MEASURES = (
    field("imaged", "imaged (%)", "imaged", 100.0),
    INSPECTED,
    field("auc", "area under the curve (%)", "inspected_auc", 100.0),
    field("time_to_50", "to 50 % (s)", "time_to_50_s", digits=0),
    field("time_to_80", "to 80 % (s)", "time_to_80_s", digits=0),
    TIME_TO_90,
    field("time_to_100", "to 100 % (s)", "time_to_100_s", digits=0),
    ORACLE_RATIO,
    field("own_end", "to its own end (s)", "sim_time_s", digits=0),
    field("all_covered", "to the paper’s coverage (s)", "all_covered_s", digits=0),
    field("idle", "standing still (%)", "idle_fraction", 100.0),
    field("path_deviations", "deviations of the path", "path_deviations"),
    field("phantoms", "phantom clusters", "phantom_clusters"),
    field("position_error", "position error (m)", "position_error_m", digits=2),
)
NOTES = (
    "Inspected: mean share of the clusters’ oyster area that the true camera had in its picture at pixels of 0.05 m or "
    "less; imaged: within 6 m. Times and the area, the mean share over the first 600 s, are of inspected; (28/30): "
    "only 28 of 30 missions reached it.",
    "Random: the whole system with a random advisor; no checks: whatever it draws is driven to. Blind sweep: straight "
    "lanes, through whatever is in the way. Oracle: a tour with the true reef, at cruise speed, without inertia; a "
    "heuristic, not a proven optimum. Oracle and blind sweep continue to their own end; the other missions only with "
    "--cfg.no-stop-when-covered.",
)


def inspection_table(
    by_variant: Mapping[str, Sequence[Row]], name: Callable[[str], str], caption: str, source: tuple[str, ...]
) -> Table:
    """Make the table of means per mission; it has no rows if no mission was judged in this way."""
    judged = {
        variant: rows for variant, rows in by_variant.items() if any(row.get("inspected") is not None for row in rows)
    }
    shown: list[Measure] = [
        m for m in MEASURES if any(m.of(row) is not None for rows in judged.values() for row in rows)
    ]
    return means_table(
        "Inspection",
        f"What was inspected, and how soon: means per mission. {caption}",
        "variant",
        {name(variant): rows for variant, rows in judged.items()},
        shown,
        (*NOTES, *source),
    )
