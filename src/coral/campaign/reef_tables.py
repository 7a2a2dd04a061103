"""Tables I, II and III of the CORAL paper from a campaign's rows, beside the paper's own numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from coral.campaign.decided import decided_table, mark_notes, marked, share
from coral.campaign.inspection_table import BASELINES, INSPECTED, TIME_TO_90, inspection_table
from coral.campaign.measure_tables import differences_table, means_table
from coral.campaign.measures import (
    Measure,
    Row,
    field,
    mean_text,
    pair,
    select,
    time_to_count,
)
from coral.campaign.presets import CLEAR, by_preset
from coral.campaign.question_table import question_table
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.sweep import setting_text
from coral.campaign.sweep_tables import sweep_tables
from coral.campaign.table import Table
from coral.foreign_file import read_json

COVERAGE = field("coverage", "coverage (%)", "coverage", 100.0)
COLLISIONS = field("collisions", "collisions", "collisions", digits=2)
CALLS = field("calls", "advisor calls", "advisor_calls")
REQUERIES = field("requeries", "of these, re-queries", "requeries")
EFFICIENCY = field("efficiency", "steps / 1 %", "steps_per_percent")
DEVIATIONS = field("deviations", "deviations", "deviations", digits=2)
MISSION_TIME = field("sim_time", "mission time (s)", "sim_time_s", digits=0)
DISTANCE = field("distance", "distance (m)", "distance_m")
TABLE_I = ("dream", "pd", "full")
TABLE_II = (
    "full",
    "paper",
    "no-verification",
    "no-centroid-selection",
    "rule-based",
    "no-trigger",
    "no-ddp",
    "no-cost-to-go",
    "no-cost-to-go-no-ddp",
    "no-topology",
)
TABLE_III = ("L", "S", "O", "K", "E")
REFERENCE = "full"
SWEPT = (COVERAGE, INSPECTED, TIME_TO_90, COLLISIONS, MISSION_TIME, DISTANCE, CALLS, DEVIATIONS)
DRAWN = (COVERAGE, COLLISIONS, MISSION_TIME)
"""Measures of a sweep, in its tables and in its figure."""


@cache
def paper() -> dict[str, Any]:
    """Load the paper's numbers, and notes on its contradictions."""
    content: dict[str, Any] = read_json(Path(__file__).parent / "reef_paper.json", "a file of this package")
    return content


def reef_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make all tables, one set for each preset and advisor: the paper's at the nominal setting, then the sweep's.

    Without the nominal setting, the paper's tables are made once for each setting.

    Args:
        rows: Rows of the data set.
        about: Conditions of the campaign: commit, machine.
        command: The command that makes the tables.
    """
    presets = by_preset(rows)
    if list(presets) == [CLEAR]:
        return _of_preset(rows, about, command)
    return [
        replace(table, caption=f"{table.caption} Preset: {preset}.")
        for preset, own in presets.items()
        for table in _of_preset(own, about, command)
    ]


def _of_preset(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    advisors = list(dict.fromkeys(row["advisor"] for row in rows if row["advisor"] != NO_ADVISOR)) or [NO_ADVISOR]
    tables = []
    settings = list(dict.fromkeys(row["overrides"] for row in rows))
    for overrides in ("{}",) if "{}" in settings else settings:
        for advisor in advisors:
            chosen = select(rows, advisor, overrides)
            if chosen:
                tables += _tables(chosen, _source(rows, chosen, advisor, overrides, about, command), advisor)
    for advisor in advisors:
        chosen = [row for overrides in settings for row in select(rows, advisor, overrides)]
        for variant in dict.fromkeys(row["variant"] for row in chosen):
            own = [row for row in chosen if row["variant"] == variant]
            tables += sweep_tables(
                own,
                SWEPT,
                f"{name(variant)}. Advisor: {called(advisor)}.",
                _source(rows, own, advisor, None, about, command),
            )
    return tables


def _tables(rows: Sequence[Row], source: tuple[str, ...], advisor: str) -> list[Table]:
    by_variant: dict[str, list[Row]] = {}
    for row in rows:
        by_variant.setdefault(row["variant"], []).append(row)
    dream = {pair(row): int(row["clusters_covered"]) for row in by_variant.get("dream", ())}
    coverage_time = time_to_count(dream)
    time_note = (
        "Coverage time: simulated time until as many clusters were covered as DREAM covered in that world and "
        "seed (paper IV-E), over the missions that reached it; (28/30) is their number."
        if dream
        else "Coverage time is measured against DREAM’s count; `dream` is not among the variants."
    )
    notes = paper()["notes"]
    first = (COVERAGE, coverage_time, COLLISIONS, CALLS)
    second = (COVERAGE, EFFICIENCY, DEVIATIONS)
    tables = []
    if any(variant in by_variant for variant in TABLE_I):
        tables += [
            _beside_paper(
                by_variant,
                "Table I",
                "Baselines",
                (*TABLE_I, *BASELINES),
                first,
                (),
                "I",
                advisor,
                (time_note, *notes["I"], *source),
            ),
            _differences(by_variant, "Table I, differences", (*TABLE_I, *BASELINES), first, advisor, source),
        ]
    if any(variant in by_variant for variant in TABLE_II):
        tables += [
            _beside_paper(
                by_variant,
                "Table II",
                "Ablations",
                (*TABLE_II, *BASELINES),
                second,
                (COLLISIONS, CALLS),
                "II",
                advisor,
                (*notes["II"], *source),
            ),
            _differences(
                by_variant,
                "Table II, differences",
                (*TABLE_II, *BASELINES),
                (*second, COLLISIONS, CALLS),
                advisor,
                source,
            ),
        ]
    if by_variant.get(REFERENCE):
        tables += [
            _by_topology(by_variant[REFERENCE], advisor, (*notes["III"], *source)),
            _by_world(by_variant[REFERENCE], advisor, source),
        ]
    tables.append(inspection_table(by_variant, name, f"Advisor: {called(advisor)}.", source))
    tables.append(question_table(by_variant, name, f"Advisor: {called(advisor)}.", source))
    everything = (COVERAGE, coverage_time, MISSION_TIME, EFFICIENCY, DISTANCE, COLLISIONS, CALLS, REQUERIES, DEVIATIONS)
    groups = {name(variant): found for variant, found in by_variant.items()}
    tables.append(
        means_table(
            "All variants",
            f"Means per mission. Advisor: {called(advisor)}.",
            "variant",
            groups,
            (*everything, share("advisor"), share("fallback")),
            (time_note, *source),
        )
    )
    caption = f"Who decided, and what it cost. Advisor: {called(advisor)}."
    tables.append(decided_table(groups, caption, source, runs="missions"))
    return [table for table in tables if table.rows]


def _beside_paper(
    by_variant: Mapping[str, Sequence[Row]],
    label: str,
    what: str,
    variants: Sequence[str],
    measures: Sequence[Measure],
    more: Sequence[Measure],
    key: str,
    advisor: str,
    notes: tuple[str, ...],
) -> Table:
    """Return our means, each measure followed by the paper's number."""
    header, rows = ["variant", "missions"], []
    for measure in measures:
        header += [measure.label, "paper"]
    for variant in variants:
        printed, each = paper()[key].get(variant, {}), paper().get(f"{key}_per_mission", {}).get(variant, {})
        found = by_variant.get(variant, ())
        if not found:
            continue
        row = [marked(name(variant), found), str(len(found))]
        for measure in measures:
            per_mission = f" ({each[measure.key]})" if measure.key in each else ""
            row += [mean_text(found, measure), printed.get(measure.key, "–") + per_mission]
        rows.append((*row, *(mean_text(found, measure) for measure in more)))
    return Table(
        label,
        f"{what}: means per mission beside the paper’s numbers. Advisor: {called(advisor)}.",
        (*header, *(measure.label for measure in more)),
        tuple(rows),
        notes,
    )


def _differences(
    by_variant: Mapping[str, Sequence[Row]],
    label: str,
    variants: Sequence[str],
    measures: Sequence[Measure],
    advisor: str,
    source: tuple[str, ...],
) -> Table:
    """Return each variant minus the reference."""
    note = (
        "Variant minus CORAL (full) in the same world with the same seed and advisor; 95 % intervals from a "
        "seeded bootstrap that draws whole worlds. ≈: the interval contains zero, so these missions do not "
        "distinguish the difference from chance."
    )
    return differences_table(
        label,
        f"Paired differences from {name(REFERENCE)}. Advisor: {called(advisor)}.",
        "variant",
        {name(variant): by_variant.get(variant, ()) for variant in variants if variant != REFERENCE},
        by_variant.get(REFERENCE, ()),
        measures,
        (note, *source),
    )


def _by_topology(rows: Sequence[Row], advisor: str, notes: tuple[str, ...]) -> Table:
    """Make Table III: one line for each topology, then the mean of all missions."""
    lines, measures = [], (COVERAGE, EFFICIENCY, CALLS)
    kinds = [*TABLE_III, *sorted({str(row.get("topology")) for row in rows} - set(TABLE_III))]
    for kind in kinds:
        found = [row for row in rows if row.get("topology") == kind]
        if not found:
            continue
        printed = paper()["III"].get(kind, {})
        line = [marked(f"{kind}-shape" if kind in TABLE_III else kind, found), str(len(found))]
        for measure in measures:
            line += [mean_text(found, measure), printed.get(measure.key, "–")]
        lines.append((*line, mean_text(found, COLLISIONS)))
    line = [marked("all missions", rows), str(len(rows))]
    for measure, value in zip(measures, ("94.28", "11.26", "54.7"), strict=True):
        line += [mean_text(rows, measure), value]
    lines.append((*line, mean_text(rows, COLLISIONS)))
    header = ["topology", "missions"]
    for measure in measures:
        header += [measure.label, "paper"]
    return Table(
        "Table III",
        f"{name(REFERENCE)} by topology, means per mission. Advisor: {called(advisor)}.",
        (*header, COLLISIONS.label),
        tuple(lines),
        ("Paper, last line: from its Tables I and II, calls per environment.", *notes),
    )


def _by_world(rows: Sequence[Row], advisor: str, source: tuple[str, ...]) -> Table:
    measures = (COVERAGE, MISSION_TIME, COLLISIONS, CALLS, REQUERIES, DEVIATIONS)
    worlds = dict.fromkeys(row["world"] for row in rows)
    lines = []
    for world in worlds:
        found = [row for row in rows if row["world"] == world]
        worst = 100.0 * min(float(row["coverage"]) for row in found)
        most = max(int(row["advisor_calls"]) for row in found)
        lines.append(
            (
                marked(world, found),
                str(len(found)),
                *(mean_text(found, measure) for measure in measures),
                f"{worst:.1f}",
                str(most),
            )
        )
    return Table(
        "By world",
        f"{name(REFERENCE)}, means per mission. Advisor: {called(advisor)}.",
        ("world", "missions", *(measure.label for measure in measures), "least coverage (%)", "most calls"),
        tuple(lines),
        source,
    )


def name(variant: str) -> str:
    """Return a variant's name in the tables."""
    return str(paper()["names"].get(variant, variant))


def _source(
    rows: Sequence[Row],
    chosen: Sequence[Row],
    advisor: str,
    overrides: str | None,
    about: Mapping[str, Any],
    command: str,
) -> tuple[str, ...]:
    """Describe the source of a table's numbers; overrides None: every setting of the selected rows' variants."""
    variants = {row["variant"] for row in chosen}
    seeds = sorted({int(row["seed"]) for row in chosen})
    worlds = list(dict.fromkeys(str(row["world"]) for row in chosen))
    failed = [
        row
        for row in rows
        if row["status"] == "failed"
        and row["advisor"] in (advisor, NO_ADVISOR)
        and (row["variant"] in variants if overrides is None else row["overrides"] == overrides)
    ]
    versions = sorted({str(row.get("code")) for row in chosen})
    parts = [
        f"Worlds: {', '.join(worlds)}. Seeds: {', '.join(map(str, seeds))}. "
        f"Commit {about.get('commit', 'unknown')} (code {', '.join(versions)}), {about.get('machine', '?')}. "
        f"Made by: {command}"
    ]
    if overrides not in ("{}", None):
        parts.append(f"Configuration: {overrides}.")
    if len(versions) > 1:
        parts.append("Mixed: these missions ran on different versions of the code.")
    if failed:
        parts.append(
            f"Failed and left out ({len(failed)}): {', '.join(_label(row) for row in failed[:4])}"
            f"{', …' if len(failed) > 4 else ''}."
        )
    parts += mark_notes(chosen)
    if any(row["advisor"] == NO_ADVISOR for row in chosen) and advisor != NO_ADVISOR:
        parts.append(
            "Variants without an advisor ran once and appear beside every advisor; their calls are questions "
            "to a rule of their own."
        )
    return tuple(parts)


def _label(row: Row) -> str:
    setting = "" if row["overrides"] == "{}" else f", {setting_text(row['overrides'])}"
    return f"{row['variant']} in {row['world']}, seed {row['seed']}{setting}"
