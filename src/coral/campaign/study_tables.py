"""The study: Tables I to III of the CORAL paper by what was inspected, for each preset and advisor, with intervals."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coral.campaign.decided import counts, mark_notes, share
from coral.campaign.inspection_table import BASELINES, INSPECTED, ORACLE_RATIO, TIME_TO_90
from coral.campaign.measure_tables import differences_table, means_table
from coral.campaign.measures import (
    Measure,
    Row,
    difference,
    difference_text,
    field,
    mean_interval_text,
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

    def named(self, *variants: str) -> dict[str, list[Row]]:
        """Return the missions of these variants under their names in the tables."""
        return {name(variant): self.by_variant.get(variant, []) for variant in variants}

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
        for label, what, variants in (("Table I", "Baselines", TABLE_I), ("Table II", "Ablations", TABLE_II)):
            shown = group.named(*variants, *BASELINES)
            tables += [
                means_table(
                    label,
                    f"{what}. {group.what}",
                    "variant",
                    shown,
                    MEASURES,
                    (*notes, *mark_notes(group.rows)),
                    text=mean_interval_text,
                ),
                differences_table(
                    f"{label}, differences",
                    f"Variant minus {name(REFERENCE)}, same world and seed. {group.what}",
                    "variant",
                    {key: rows for key, rows in shown.items() if key != name(REFERENCE)},
                    group.by_variant.get(REFERENCE, ()),
                    COMPARED,
                    ("≈: the interval holds zero.", *notes[2:]),
                ),
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


def _by_topology(group: Group, notes: tuple[str, ...]) -> Table:
    groups = {
        f"{f'{kind}-shape' if kind in TABLE_III else kind}: {named}": [r for r in rows if r.get("topology") == kind]
        for kind in _topologies(group.rows)
        for named, rows in group.named(REFERENCE, *BASELINES).items()
    }
    return means_table(
        "Table III",
        f"{name(REFERENCE)} and the references by topology. {group.what}",
        "topology",
        groups,
        MEASURES,
        notes,
        text=mean_interval_text,
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
