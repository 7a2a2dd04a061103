"""Tables I, II and III of the CORAL paper from a campaign's rows, beside the paper's own numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from coral.campaign.decided import decided_table, left_out, made_by, mark_notes, marked, share
from coral.campaign.inspection_table import (
    BASELINES,
    HORIZON_S,
    INSPECTED,
    ORACLE_RATIO,
    RESTRICTED,
    TIME_TO_90,
    inspection_table,
)
from coral.campaign.measure_tables import differences_table, means_table
from coral.campaign.measures import (
    Measure,
    Row,
    difference,
    difference_text,
    field,
    mean_text,
    pair,
    select,
    time_to_count,
)
from coral.campaign.presets import CLEAR, by_preset
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.stats import FEW_WORLDS
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
LAST_LINE = "Paper, last line: from its Tables I and II, calls per environment."
ALL_MISSIONS = {"coverage": "94.28", "efficiency": "11.26", "calls": "54.7"}
"""The paper's means over all topologies."""
REFERENCE = "full"
SWEPT = (COVERAGE, INSPECTED, TIME_TO_90, COLLISIONS, MISSION_TIME, DISTANCE, CALLS, DEVIATIONS)
"""Measures of a sweep."""
INSPECTING = (INSPECTED, RESTRICTED, ORACLE_RATIO)
"""Measures of what was inspected in the tables of differences. The time to 90 % itself is not among them: its pairs
would leave out what failed."""
DIFFERENCE = (
    "Variant minus CORAL (full) in the same world with the same seed and advisor; 95 % intervals from a "
    "seeded bootstrap that draws whole worlds. ≈: the interval contains zero, so these missions do not "
    "distinguish the difference from chance."
)


@cache
def paper() -> dict[str, Any]:
    """Load the paper's numbers, and notes on its contradictions."""
    content: dict[str, Any] = read_json(Path(__file__).parent / "reef_paper.json", "a file of this package")
    return content


def reef_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make all tables, one set for each preset and advisor: the paper's at the nominal setting, then the sweep's.

    Without the nominal setting, the paper's tables are made once for each setting. With several presets or advisors,
    the last table puts the effects of the variants side by side.

    Args:
        rows: Rows of the data set.
        about: Conditions of the campaign: commit, machine.
        command: The command that makes the tables.
    """
    presets = by_preset(rows)
    tables = []
    for preset, own in presets.items():
        made = _of_preset(own, about, command)
        told = "" if list(presets) == [CLEAR] else f" Preset: {preset}."
        tables += [replace(table, caption=f"{table.caption}{told}") for table in made]
    return [table for table in (*tables, effects_table(rows)) if table.rows]


def _of_preset(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    tables = []
    settings = list(dict.fromkeys(row["overrides"] for row in rows))
    for overrides in ("{}",) if "{}" in settings else settings:
        for advisor in _advisors(rows):
            chosen = select(rows, advisor, overrides)
            if chosen:
                tables += _tables(chosen, _source(rows, chosen, advisor, overrides, about, command), advisor)
    for advisor in _advisors(rows):
        chosen = [row for overrides in settings for row in select(rows, advisor, overrides)]
        for variant, own in by_variant(chosen).items():
            tables += sweep_tables(
                own,
                SWEPT,
                f"{name(variant)}. Advisor: {called(advisor)}.",
                _source(rows, own, advisor, None, about, command),
            )
    return tables


def _advisors(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(row["advisor"] for row in rows if row["advisor"] != NO_ADVISOR)) or [NO_ADVISOR]


def by_variant(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Group missions by variant, in the order of the campaign."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row["variant"], []).append(row)
    return found


def _tables(rows: Sequence[Row], source: tuple[str, ...], advisor: str) -> list[Table]:
    found, who = by_variant(rows), f"Advisor: {called(advisor)}."
    groups = {name(variant): own for variant, own in found.items()}
    dream = {pair(row): int(row["clusters_covered"]) for row in found.get("dream", ())}
    coverage_time = time_to_count(dream)
    time_note = (
        "Coverage time: simulated time until as many clusters were covered as DREAM covered in that world and "
        "seed (paper IV-E), over the missions that reached it; (28/30) is their number."
        if dream
        else "Coverage time is measured against DREAM’s count; `dream` is not among the variants."
    )
    numbers, full = paper(), found.get(REFERENCE, ())
    tables = []
    for key, what, variants, measures, more in (
        ("I", "Baselines", TABLE_I, (COVERAGE, coverage_time, COLLISIONS, CALLS), ()),
        ("II", "Ablations", TABLE_II, (COVERAGE, EFFICIENCY, DEVIATIONS), (COLLISIONS, CALLS)),
    ):
        if not any(variant in found for variant in variants):
            continue
        each = numbers.get(f"{key}_per_mission", {})
        shown = [variant for variant in (*variants, *BASELINES) if variant in found]
        lines = [
            (name(variant), found[variant], _printed(numbers[key].get(variant, {}), each.get(variant, {})))
            for variant in shown
        ]
        caption = f"{what}: means per mission beside the paper’s numbers. {who}"
        notes = (*((time_note,) if coverage_time in measures else ()), *numbers["notes"][key], *source)
        tables += [
            _beside_paper(f"Table {key}", caption, "variant", lines, measures, more, notes),
            differences_table(
                f"Table {key}, differences",
                f"Paired differences from {name(REFERENCE)}. {who}",
                "variant",
                {name(variant): found[variant] for variant in shown if variant != REFERENCE},
                full,
                [m for m in (*measures, *more, *INSPECTING) if any(m.of(row) is not None for row in rows)],
                (DIFFERENCE, *source),
            ),
        ]
    if full:
        kinds = [kind for kind in TABLE_III if any(row.get("topology") == kind for row in full)]
        kinds += sorted({str(row.get("topology")) for row in full} - set(TABLE_III))
        lines = [
            (
                f"{kind}-shape" if kind in TABLE_III else kind,
                [row for row in full if row.get("topology") == kind],
                numbers["III"].get(kind, {}),
            )
            for kind in kinds
        ]
        worlds = {world: [row for row in full if row["world"] == world] for world in {r["world"]: 0 for r in full}}
        tables += [
            _beside_paper(
                "Table III",
                f"{name(REFERENCE)} by topology, means per mission. {who}",
                "topology",
                [*lines, ("all missions", full, ALL_MISSIONS)],
                (COVERAGE, EFFICIENCY, CALLS),
                (COLLISIONS,),
                (LAST_LINE, *numbers["notes"]["III"], *source),
            ),
            means_table(
                "By world",
                f"{name(REFERENCE)}, means per mission. {who}",
                "world",
                worlds,
                (COVERAGE, MISSION_TIME, COLLISIONS, CALLS, REQUERIES, DEVIATIONS),
                source,
            ),
        ]
    everything = (COVERAGE, coverage_time, MISSION_TIME, EFFICIENCY, DISTANCE, COLLISIONS, CALLS, REQUERIES, DEVIATIONS)
    tables += [
        inspection_table(groups, who, source),
        means_table(
            "All variants",
            f"Means per mission. {who}",
            "variant",
            groups,
            (*everything, share("advisor"), share("fallback")),
            (time_note, *source),
        ),
        decided_table(groups, f"Who decided, and what it cost. {who}", source, runs="missions"),
    ]
    return [table for table in tables if table.rows]


def _printed(numbers: Mapping[str, str], per_mission: Mapping[str, str]) -> dict[str, str]:
    """Return the paper's numbers by measure, with what a total is for each mission."""
    return {key: f"{text} ({per_mission[key]})" if key in per_mission else text for key, text in numbers.items()}


def _beside_paper(
    label: str,
    caption: str,
    by: str,
    lines: Sequence[tuple[str, Sequence[Row], Mapping[str, str]]],
    measures: Sequence[Measure],
    more: Sequence[Measure],
    notes: tuple[str, ...],
) -> Table:
    """Make a table of our means, each but those of `more` followed by the paper's number.

    Args:
        label: Name of the table.
        caption: Its caption.
        by: What a line is, such as "variant".
        lines: Name, missions, and the paper's numbers by measure.
        measures: Measures that the paper has.
        more: Others.
        notes: Notes under the table.
    """
    header = [by, "missions", *(text for m in measures for text in (m.label, "paper")), *(m.label for m in more)]
    rows = []
    for line, found, printed in lines:
        cells = [text for m in measures for text in (mean_text(found, m), printed.get(m.key, "–"))]
        rows.append((marked(line, found), str(len(found)), *cells, *(mean_text(found, m) for m in more)))
    return Table(label, caption, tuple(header), tuple(rows), notes)


def effects_table(rows: Sequence[Row]) -> Table:
    """Make a line for each variant: by how much slower it is than the whole system, in every water with every advisor.

    Without several of these, or without missions that were judged by inspection, there are no lines.
    """
    found = {
        f"{preset}, {advisor}": by_variant(select(own, advisor, "{}"))
        for preset, own in by_preset(rows).items()
        for advisor in _advisors(rows)
    }
    found = {condition: own for condition, own in found.items() if own}
    variants = dict.fromkeys(variant for own in found.values() for variant in own if variant != REFERENCE)
    judged = len(found) > 1 and any(RESTRICTED.of(row) is not None for row in rows)
    return Table(
        "Effects",
        f"Difference from {name(REFERENCE)} in the time to 90 % inspected (s), {HORIZON_S:.0f} s where never: "
        "above zero is slower.",
        ("variant", *found),
        tuple(
            (
                name(variant),
                *(
                    difference_text(difference(own.get(variant, []), own.get(REFERENCE, []), RESTRICTED), 0)
                    for own in found.values()
                ),
            )
            for variant in variants
            if judged
        ),
        ("≈: the interval holds zero, so these missions do not tell the difference from chance.",),
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
    made = made_by(chosen, about, command)
    parts = [f"Worlds: {', '.join(worlds)}. Seeds: {', '.join(map(str, seeds))}. {made}"]
    if overrides not in ("{}", None):
        parts.append(f"Configuration: {overrides}.")
    if len(worlds) < FEW_WORLDS:
        parts.append(f"Few worlds to draw from ({len(worlds)}): intervals are narrower than they should be.")
    parts += [*left_out(failed, _label), *mark_notes(chosen)]
    if any(row["advisor"] == NO_ADVISOR for row in chosen) and advisor != NO_ADVISOR:
        parts.append(
            "Variants without an advisor ran once and appear beside every advisor; their calls are questions "
            "to a rule of their own."
        )
    return tuple(parts)


def _label(row: Row) -> str:
    setting = "" if row["overrides"] == "{}" else f", {setting_text(row['overrides'])}"
    return f"{row['variant']} in {row['world']}, seed {row['seed']}{setting}"
