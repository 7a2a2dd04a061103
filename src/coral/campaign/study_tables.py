"""The study: Tables I to III of the CORAL paper by what was inspected, for each preset and advisor, with intervals."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coral.campaign.decided import counts, mark_notes, marked, share
from coral.campaign.inspection_table import BASELINES, INSPECTED, ORACLE_RATIO, TIME_TO_90
from coral.campaign.measures import (
    Measure,
    Row,
    difference,
    difference_text,
    field,
    mean,
    mean_interval_text,
    pair,
    select,
)
from coral.campaign.presets import by_preset
from coral.campaign.reef_tables import COVERAGE, REFERENCE, TABLE_I, TABLE_II, TABLE_III, name
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.sweep_tables import FEW_WORLDS
from coral.campaign.table import Table

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


RESTRICTED = Measure("time_to_90_restricted", f"to 90 %, at most {HORIZON_S:.0f} s (s)", _restricted, 0)
MEASURES = (
    INSPECTED,
    TIME_TO_90,
    RESTRICTED,
    ORACLE_RATIO,
    COVERAGE,
    field("idle", "standing still (%)", "idle_fraction", 100.0),
    Measure("refused", "answers refused (%)", _refused),
    field("collisions", "collisions", "collisions", digits=2),
    field("path_deviations", "deviations of the path", "path_deviations"),
    field("calls", "advisor calls", "advisor_calls"),
    share("advisor"),
)
COMPARED = tuple(m for m in MEASURES if m.key not in ("time_to_90", "by_advisor"))
"""Of the differences; the restricted time stands for the other one, whose pairs would leave out what failed."""
NOTES = (
    "Means per mission with 95 % intervals from a seeded bootstrap that draws whole worlds; (8/10): only 8 of 10 "
    "missions have that number.",
    f"To 90 %: time until nine tenths of the oysters’ area were inspected; at most {HORIZON_S:.0f} s: the same, with "
    f"{HORIZON_S:.0f} s for missions that never got there. × oracle: over the time of a tour that knows the reef.",
    "Blind sweep, random advisor (with and without checks) and oracle are references, and ask no "
    "advisor. Nobody decides for a method whose answers fail; §: decisions that were not reached.",
)


@dataclass(frozen=True)
class Group:
    """The missions of one table: one preset, one advisor and those that ask none."""

    preset: str
    advisor: str
    rows: Sequence[Row]

    @property
    def by_variant(self) -> dict[str, list[Row]]:
        """Return the missions of each variant, in the order of the campaign."""
        found: dict[str, list[Row]] = {}
        for row in self.rows:
            found.setdefault(row["variant"], []).append(row)
        return found

    @property
    def what(self) -> str:
        """Return the words of a caption."""
        return f"Preset: {self.preset}. Advisor: {called(self.advisor)}."


def study_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make the tables of all presets and advisors.

    Args:
        rows: Of the data set.
        about: Of the campaign: commit, machine.
        command: That makes the tables.
    """
    tables: list[Table] = []
    for group in groups(rows):
        notes = (*NOTES, *_source(group, about, command))
        for label, variants in (("Table I", TABLE_I), ("Table II", TABLE_II)):
            tables += [
                _means(group, label, _ordered(variants), notes),
                _differences(group, f"{label}, differences", _ordered(variants), notes[2:]),
            ]
        tables.append(_by_topology(group, notes))
    effects = _effects(groups(rows))
    return [table for table in (*tables, effects) if table.rows]


def groups(rows: Sequence[Row]) -> list[Group]:
    """Return the groups of a study's rows that have missions, those of the first preset first."""
    advisors = list(dict.fromkeys(row["advisor"] for row in rows if row["advisor"] != NO_ADVISOR)) or [NO_ADVISOR]
    found = [
        Group(preset, advisor, select(own, advisor, json.dumps({})))
        for preset, own in by_preset(rows).items()
        for advisor in advisors
    ]
    return [group for group in found if group.rows]


def study_csv(rows: Sequence[Row]) -> str:
    """Return every number of the tables, one a line; differences are paired, from the whole system."""
    text = io.StringIO()
    lines = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    lines.writeheader()
    for group in groups(rows):
        kinds = ["all", *_topologies(group.rows)]
        for kind in kinds:
            own = [row for row in group.rows if kind == "all" or row.get("topology") == kind]
            lines.writerows(_cells(Group(group.preset, group.advisor, own), kind))
    return text.getvalue()


COLUMNS = (
    "preset",
    "advisor",
    "topology",
    "variant",
    "measure",
    "mean",
    "low",
    "high",
    "missions",
    "defined",
    "difference",
    "difference_low",
    "difference_high",
    "pairs",
)


def _cells(group: Group, kind: str) -> Iterator[dict[str, Any]]:
    reference = group.by_variant.get(REFERENCE, [])
    for variant, found in group.by_variant.items():
        for measure in MEASURES:
            estimate, apart = mean(found, measure), difference(found, reference, measure)
            yield {
                "preset": group.preset,
                "advisor": NO_ADVISOR if found[0]["advisor"] == NO_ADVISOR else group.advisor,
                "topology": kind,
                "variant": variant,
                "measure": measure.key,
                "missions": len(found),
                "defined": estimate.count,
                **_numbers("mean", "low", "high", values=(estimate.mean, estimate.low, estimate.high)),
                **_numbers(
                    "difference",
                    "difference_low",
                    "difference_high",
                    values=(apart.mean, apart.low, apart.high) if variant != REFERENCE else (math.nan,) * 3,
                ),
                "pairs": apart.count if variant != REFERENCE else 0,
            }


def _numbers(*names: str, values: Sequence[float]) -> dict[str, str]:
    """Format numbers for the CSV; empty where there is none."""
    return {key: "" if math.isnan(value) else f"{value:.6g}" for key, value in zip(names, values, strict=True)}


def _ordered(variants: Sequence[str]) -> tuple[str, ...]:
    return (*variants, *BASELINES)


def _means(group: Group, label: str, variants: Sequence[str], notes: tuple[str, ...]) -> Table:
    by_variant = group.by_variant
    return Table(
        label,
        f"{_CAPTION[label]} {group.what}",
        ("variant", "missions", *(measure.label for measure in MEASURES)),
        tuple(
            (marked(name(variant), found), str(len(found)), *(mean_interval_text(found, m) for m in MEASURES))
            for variant in variants
            if (found := by_variant.get(variant))
        ),
        (*notes, *mark_notes(group.rows)),
    )


def _differences(group: Group, label: str, variants: Sequence[str], notes: tuple[str, ...]) -> Table:
    by_variant, lines = group.by_variant, []
    reference = by_variant.get(REFERENCE, [])
    for variant in variants if reference else ():
        found = by_variant.get(variant)
        if variant == REFERENCE or not found:
            continue
        pairs = len({pair(row) for row in found} & {pair(row) for row in reference})
        apart = [difference_text(difference(found, reference, measure), measure.digits) for measure in COMPARED]
        lines.append((marked(name(variant), found), str(pairs), *apart))
    return Table(
        label,
        f"Variant minus {name(REFERENCE)}, same world and seed. {group.what}",
        ("variant", "pairs", *(f"Δ {measure.label}" for measure in COMPARED)),
        tuple(lines),
        ("≈: the interval holds zero.", *notes),
    )


def _by_topology(group: Group, notes: tuple[str, ...]) -> Table:
    by_variant, lines = group.by_variant, []
    for kind in _topologies(group.rows):
        for variant in (REFERENCE, *BASELINES):
            found = [row for row in by_variant.get(variant, ()) if row.get("topology") == kind]
            if found:
                shape = f"{kind}-shape" if kind in TABLE_III else kind
                cells = (mean_interval_text(found, measure) for measure in MEASURES)
                lines.append((marked(f"{shape}: {name(variant)}", found), str(len(found)), *cells))
    return Table(
        "Table III",
        f"{_CAPTION['Table III']} {group.what}",
        ("topology", "missions", *(measure.label for measure in MEASURES)),
        tuple(lines),
        notes,
    )


def _effects(found: Sequence[Group]) -> Table:
    """One line for each variant: by how much slower it is than the whole system, with every advisor in every water."""
    variants = dict.fromkeys(v for group in found for v in group.by_variant if v != REFERENCE)
    lines = []
    for variant in variants:
        cells = []
        for group in found:
            ours, reference = group.by_variant.get(variant, []), group.by_variant.get(REFERENCE, [])
            cells.append(difference_text(difference(ours, reference, RESTRICTED), RESTRICTED.digits))
        lines.append((name(variant), *cells))
    return Table(
        "Effects",
        f"Difference from {name(REFERENCE)} in the time to 90 % inspected (s), {HORIZON_S:.0f} s where never: "
        "above zero is slower.",
        ("variant", *(f"{group.preset}, {group.advisor}" for group in found)),
        tuple(lines),
        ("≈: the interval holds zero, so these missions do not tell the difference from chance.",),
    )


def _topologies(rows: Sequence[Row]) -> list[str]:
    there = {str(row.get("topology")) for row in rows}
    return [*(kind for kind in TABLE_III if kind in there), *sorted(there - set(TABLE_III))]


def _source(group: Group, about: Mapping[str, Any], command: str) -> tuple[str, ...]:
    worlds = list(dict.fromkeys(str(row["world"]) for row in group.rows))
    seeds = sorted({int(row["seed"]) for row in group.rows})
    few = f"Few worlds to draw from ({len(worlds)}): these intervals are narrower than they should be. "
    return (
        f"{few if len(worlds) < FEW_WORLDS else ''}Worlds: {', '.join(worlds)}. Seeds: {', '.join(map(str, seeds))}. "
        f"Commit {about.get('commit', 'unknown')}, {about.get('machine', '?')}. Made by: {command}",
    )


_CAPTION = {
    "Table I": "Baselines.",
    "Table II": "Ablations.",
    "Table III": f"{name(REFERENCE)} and the references by topology.",
}
