"""The tables of a survey's campaign: I, II and III of the CORAL paper beside its numbers, inspection, sweeps, words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from coral.campaign.columns import (
    PAIRS,
    WON,
    WON_INTERVAL,
    Column,
    Group,
    Measure,
    Row,
    column_measure,
    count,
    counts,
    group_by,
    of_successes,
    pair,
    tabulate,
)
from coral.campaign.decided import advisors, decided_table, left_out, made_by, mark_notes, share
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.stats import FEW_WORLDS
from coral.campaign.sweep import CLEAR, NOMINAL, by_preset, in_order, setting_text
from coral.campaign.table import Table
from coral.foreign_file import read_json

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


def _met(condition: str, row: Row) -> float | None:
    found = [one["met"] for one in row["conditions"] if one["condition"] == condition]
    return 100.0 * sum(found) / len(found) if found else None


def _late(row: Row) -> float | None:
    late, calls = row.get("late_calls"), row.get("advisor_calls")
    return None if late is None or not calls else 100.0 * late / calls


COVERAGE = column_measure("coverage", "coverage (%)", "coverage", 100.0)
COVERAGE_TIME = column_measure("coverage_time", "coverage time (s)", "coverage_time_s", digits=0)
COLLISIONS = column_measure("collisions", "collisions", "collisions", digits=2)
CALLS = column_measure("calls", "advisor calls", "advisor_calls")
REQUERIES = column_measure("requeries", "of these, re-queries", "requeries")
EFFICIENCY = column_measure("efficiency", "steps / 1 %", "steps_per_percent")
DEVIATIONS = column_measure("deviations", "deviations", "deviations", digits=2)
MISSION_TIME = column_measure("sim_time", "mission time (s)", "sim_time_s", digits=0)
DISTANCE = column_measure("distance", "distance (m)", "distance_m")
INSPECTED = column_measure("inspected", "inspected (%)", "inspected", 100.0)
TIME_TO_90 = column_measure("time_to_90", "to 90 % (s)", "time_to_90_s", digits=0)
RESTRICTED = Measure("time_to_90_restricted", f"to 90 %, at most {HORIZON_S:.0f} s (s)", _restricted, 0)
ORACLE_RATIO = column_measure("oracle_ratio", "× oracle, to 90 %", "oracle_ratio_90", digits=2)
REFUSED = Measure("refused", "answers refused (%)", _refused)
INSPECTION = (
    column_measure("imaged", "imaged (%)", "imaged", 100.0),
    INSPECTED,
    *(column_measure(f"at_{s}", f"after {s} s (%)", f"inspected_at_{s}_s", 100.0) for s in (45, 60, 90)),
    column_measure("auc", "area under the curve (%)", "inspected_auc", 100.0),
    column_measure("time_to_50", "to 50 % (s)", "time_to_50_s", digits=0),
    column_measure("time_to_80", "to 80 % (s)", "time_to_80_s", digits=0),
    TIME_TO_90,
    RESTRICTED,
    column_measure("time_to_100", "to 100 % (s)", "time_to_100_s", digits=0),
    ORACLE_RATIO,
    column_measure("own_end", "to its own end (s)", "sim_time_s", digits=0),
    column_measure("all_covered", "to the paper’s coverage (s)", "all_covered_s", digits=0),
    column_measure("idle", "standing still (%)", "idle_fraction", 100.0),
    REFUSED,
    Measure("late", "calls after everything was inspected (%)", _late),
    column_measure("path_deviations", "deviations of the path", "path_deviations"),
    column_measure("phantoms", "phantom clusters", "phantom_clusters"),
    column_measure("position_error", "position error (m)", "position_error_m", digits=2),
)
INSPECTING = (INSPECTED, RESTRICTED, ORACLE_RATIO)
"""Measures of what was inspected in the tables of differences. The time to 90 % itself is not among them: its pairs
would leave out what failed."""
SWEPT = (COVERAGE, INSPECTED, TIME_TO_90, COLLISIONS, MISSION_TIME, DISTANCE, CALLS, DEVIATIONS)
EVERYTHING = (
    *(COVERAGE, COVERAGE_TIME, MISSION_TIME, EFFICIENCY, DISTANCE, COLLISIONS, CALLS, REQUERIES, DEVIATIONS),
    *(share("advisor"), share("fallback")),
)
WORDS = (
    WON,
    WON_INTERVAL,
    of_successes(column_measure("over_oracle", "time × oracle", "over_oracle", digits=2).mean()),
    Measure("spared", "spared (%)", partial(_met, "spared"), 0).mean(),
    Measure("kept_off", "kept off (%)", partial(_met, "kept_off"), 0).mean(),
    Column("contacts", lambda group: str(sum(int(row["collisions"]) for row in group.rows))),
)
TABLE_I = ("dream", "pd", "full")
TABLE_II = (
    *("full", "paper", "no-verification", "no-centroid-selection", "rule-based", "no-trigger", "no-ddp"),
    *("no-cost-to-go", "no-cost-to-go-no-ddp", "no-topology"),
)
TABLE_III = ("L", "S", "O", "K", "E")
UNCHECKED = {
    "full": "no-verification",
    "clairvoyant": "clairvoyant-unchecked",
    "random": "random-unchecked",
    "constant": "constant-unchecked",
}
"""Variants with the check of answers, and the same without it."""
BASELINES = ("lawnmower", "blind-sweep", *list(UNCHECKED)[1:], *list(UNCHECKED.values())[1:], "oracle")
"""Lines of every table that compares variants, if they ran: classical and blind surveys, advisors that know all or
nothing with and without checks, upper bound."""
REFERENCE = "full"
ALL_MISSIONS = {"coverage": "94.28", "efficiency": "11.26", "calls": "54.7"}
"""The paper's means over all topologies."""
UNTOLD = "≈: the interval contains zero, so these missions do not distinguish the difference from chance."
WORSE_SHARE, WORSE_S = 0.02, 10.0
"""With the check a mission is worse if it inspects less by this share, or as much, and 90 % later by this time (s)."""
GATE_NOTE = (
    "Each mission with the check beside the same world and seed without it. Worse: less was inspected by more than "
    f"{100 * WORSE_SHARE:.0f} points, or as much, and 90 % more than {WORSE_S:.0f} s later. {UNTOLD}"
)
LAST_LINE = "Paper, last line: from its Tables I and II, calls per environment."
DIFFERENCE = (
    "Variant minus CORAL (full) in the same world with the same seed and advisor; 95 % intervals from a "
    f"seeded bootstrap that draws whole worlds. {UNTOLD}"
)
TIME_NOTE = (
    "Coverage time: simulated time until as many clusters were covered as DREAM covered in that world and "
    "seed (paper IV-E), over the missions that reached it; (28/30) is their number."
)
NO_DREAM = "Coverage time is measured against DREAM’s count; `dream` is not among the variants."
INSPECTION_NOTES = (
    "Means with 95 % intervals from a seeded bootstrap that draws whole worlds; (28/30): only 28 of 30 missions have "
    "that number. Inspected: mean share of the clusters’ oyster area that the true camera had in its picture at "
    "pixels of 0.05 m or less; imaged: within 6 m. Times and the area, the mean share over the first 600 s, are of "
    f"inspected; at most {HORIZON_S:.0f} s: with {HORIZON_S:.0f} s for missions that never got there.",
    "Random, constant, clairvoyant: the whole system with an advisor that draws lots, always says the same, or knows "
    "the true clusters; no checks: wherever it says is driven to. Lawnmower: lanes planned before, driven around what "
    "is on the map. Blind sweep: straight lanes, through whatever is in the way. Oracle: a tour with the true reef, at "
    "cruise speed, without inertia; a heuristic, not a proven optimum. Oracle and blind sweep continue to their own "
    "end; the other missions only with --cfg.no-stop-when-covered.",
)
SWEEP_MEANS = (
    "One key is changed at a time; nominal: none. 95 % intervals from a seeded bootstrap that draws whole "
    "worlds. (8/9): only 8 of 9 missions have that number."
)
SWEEP_DIFFERENCES = (
    "Setting minus nominal in the same world with the same seed and advisor; 95 % intervals from the same "
    f"bootstrap. {UNTOLD}"
)
WORD_NOTES = (
    "Success: all conditions of the mission met in truth, without a contact, with 95 % intervals (Wilson). Time: of "
    "successes, over that of an oracle that knows what everything is. Spared, kept off: mean share of such "
    "conditions by which what was to be left alone was not seen from near, or was not passed too near.",
    "full with the rules visits everything; geometry knows the conditions, not kinds; keywords reads key words; "
    "lawnmower follows lanes.",
)


PAPER: dict[str, Any] = read_json(Path(__file__).parent / "reef_paper.json", "a file of this package")
"""The paper's numbers, and notes on its contradictions."""


def reef_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make all tables, one set for each preset and advisor: the paper's at the nominal setting, then the sweep's.

    With several presets or advisors, the last table puts the effects of the variants side by side. `about` are the
    conditions of the campaign: commit, machine.
    """
    presets = by_preset(rows)
    tables = []
    for preset, of_preset in presets.items():
        told = "" if list(presets) == [CLEAR] else f" Preset: {preset}."
        for advisor in advisors(rows):
            own = [row for row in of_preset if row["advisor"] in (advisor, NO_ADVISOR)]
            source = partial(_source, advisor=advisor, about=about, command=command)
            made = _nominal_tables([row for row in own if row["overrides"] == "{}"], advisor, source)
            for variant, swept in group_by(own, lambda row: row["variant"]).items():
                made += _sweep_tables(swept, f"{name(variant)}. Advisor: {called(advisor)}.", source)
            tables += [replace(table, caption=f"{table.caption}{told}") for table in made]
    return [table for table in (*tables, _effects(presets, advisors(rows))) if table.rows]


def _by_variant(rows: Sequence[Row]) -> dict[str, list[Row]]:
    return group_by([row for row in rows if row["status"] == "done"], lambda row: row["variant"])


def _nominal_tables(rows: Sequence[Row], advisor: str, source_of: Callable[..., tuple[str, ...]]) -> list[Table]:
    """Make the tables of one advisor in one water, with nothing swept."""
    source, who = source_of(rows), f"Advisor: {called(advisor)}."
    found = _by_variant(_with_coverage_time(rows))
    full = found.get(REFERENCE, [])
    groups = {variant: Group(name(variant), own, full) for variant, own in found.items()}
    everything = [row for own in found.values() for row in own]
    time_note = TIME_NOTE if "dream" in found else NO_DREAM
    tables: list[Table] = []

    def add(title: str, what: str, by: str, lines: Sequence[Group], columns: Sequence[Column], *notes: str) -> None:
        tables.append(tabulate(title, f"{what} {who}", by, lines, columns, (*notes, *source)))

    for key, what, variants, measures, more in (
        ("I", "Baselines", TABLE_I, (COVERAGE, COVERAGE_TIME, COLLISIONS, CALLS), ()),
        ("II", "Ablations", TABLE_II, (COVERAGE, EFFICIENCY, DEVIATIONS), (COLLISIONS, CALLS)),
    ):
        if not any(variant in found for variant in variants):
            continue
        shown = [variant for variant in (*variants, *BASELINES) if variant in found]
        title, notes = f"Table {key}", (*((time_note,) if COVERAGE_TIME in measures else ()), *PAPER["notes"][key])
        lines = [replace(groups[variant], printed=_printed(key, variant)) for variant in shown]
        beside = f"{what}: means per mission beside the paper’s numbers."
        add(title, beside, "variant", lines, _beside_paper(measures, more), *notes)
        compared = [m for m in (*measures, *more, *INSPECTING) if any(m.of(row) is not None for row in everything)]
        others = [groups[variant] for variant in shown if full and variant != REFERENCE]
        columns = (PAIRS, *(measure.difference() for measure in compared))
        from_full = f"Paired differences from {name(REFERENCE)}."
        add(f"{title}, differences", from_full, "variant", others, columns, DIFFERENCE)
    missions = count("missions")
    if full:
        kinds = group_by(full, lambda row: str(row.get("topology")))
        lines = [
            Group(f"{kind}-shape" if kind in TABLE_III else kind, kinds[kind], printed=PAPER["III"].get(kind, {}))
            for kind in (*(kind for kind in TABLE_III if kind in kinds), *sorted(set(kinds) - set(TABLE_III)))
        ]
        lines.append(Group("all missions", full, printed=ALL_MISSIONS))
        by_topology, notes = f"{name(REFERENCE)} by topology, means per mission.", (LAST_LINE, *PAPER["notes"]["III"])
        beside_theirs = _beside_paper((COVERAGE, EFFICIENCY, CALLS), (COLLISIONS,))
        add("Table III", by_topology, "topology", lines, beside_theirs, *notes)
        worlds = [Group(world, own) for world, own in group_by(full, lambda row: row["world"]).items()]
        by_world = (COVERAGE, MISSION_TIME, COLLISIONS, CALLS, REQUERIES, DEVIATIONS)
        means = (missions, *(measure.mean() for measure in by_world))
        add("By world", f"{name(REFERENCE)}, means per mission.", "world", worlds, means)
    judged = [g for g in groups.values() if any(row.get("inspected") is not None for row in g.rows)]
    inspection = [m for m in INSPECTION if any(m.of(row) is not None for group in judged for row in group.rows)]
    intervals = (missions, *(measure.interval() for measure in inspection))
    seen = "What was inspected, and how soon: means per mission."
    add("Inspection", seen, "variant", judged, intervals, *INSPECTION_NOTES)
    checked = [
        Group(name(variant), found[variant], found[other])
        for variant, other in UNCHECKED.items()
        if variant in found and other in found
    ]
    add("Verification", "With the check of answers and without it.", "advisor", checked, GATE, GATE_NOTE)
    means = (missions, *(measure.mean() for measure in EVERYTHING))
    add("All variants", "Means per mission.", "variant", list(groups.values()), means, time_note)
    decided = decided_table(list(groups.values()), f"Who decided, and what it cost. {who}", source, runs="missions")
    return [table for table in (*tables, decided) if table.rows]


def _without(column: Column) -> Column:
    """Return the same column of the missions without the check."""
    return Column(f"{column.label}, without", lambda group: column.text(replace(group, rows=group.reference)))


def _worse(group: Group) -> str:
    """Count the missions that are worse with the check."""
    without = {pair(row): row for row in group.reference}
    worse = 0
    for row in group.rows:
        other = without.get(pair(row))
        ours, theirs = (None, None) if other is None else (_restricted(row), _restricted(other))
        if other is None or ours is None or theirs is None:
            continue
        gained = row["inspected"] - other["inspected"]
        worse += gained < -WORSE_SHARE or (gained <= WORSE_SHARE and ours > theirs + WORSE_S)
    return str(worse)


GATE = (
    *(PAIRS, INSPECTED.mean(), _without(INSPECTED.mean()), RESTRICTED.mean(), _without(RESTRICTED.mean())),
    *(RESTRICTED.difference(), COLLISIONS.mean(), _without(COLLISIONS.mean()), REFUSED.mean()),
    Column("worse missions", _worse),
)


def _beside_paper(measures: Sequence[Measure], more: Sequence[Measure]) -> list[Column]:
    """Return the columns of our means, each but those of `more` followed by the paper's number."""
    beside = [column for measure in measures for column in (measure.mean(), measure.paper())]
    return [count("missions"), *beside, *(measure.mean() for measure in more)]


def _printed(table: str, variant: str) -> dict[str, str]:
    """Return the paper's numbers by measure, with what a total is for each mission."""
    each = PAPER.get(f"{table}_per_mission", {}).get(variant, {})
    numbers = PAPER[table].get(variant, {})
    return {key: f"{text} ({each[key]})" if key in each else text for key, text in numbers.items()}


def _with_coverage_time(rows: Sequence[Row]) -> list[Row]:
    """Add the time (s) at which a mission covered as many clusters as DREAM with its seed (paper IV-E: K_i).

    None if it never did, if DREAM did not run there, or if DREAM covered nothing.
    """
    dream = {pair(r): int(r["clusters_covered"]) for r in rows if r["variant"] == "dream" and r["status"] == "done"}
    found: list[Row] = []
    for row in rows:
        needed, times = dream.get(pair(row), 0), row.get("covered_at_s") or ()
        found.append({**row, "coverage_time_s": times[needed - 1] if 0 < needed <= len(times) else None})
    return found


def _sweep_tables(rows: Sequence[Row], caption: str, source_of: Callable[..., tuple[str, ...]]) -> list[Table]:
    """Make two tables of one variant's missions under one advisor; none if nothing was swept."""
    done = [row for row in rows if row["status"] == "done"]
    found = group_by(done, lambda row: row["overrides"])
    settings = {setting_text(overrides): found[overrides] for overrides in in_order(found)}
    changed = [setting for setting in settings if setting != NOMINAL]
    if not changed:
        return []
    source, nominal = source_of(rows), settings.get(NOMINAL, [])
    return [
        tabulate(
            "Sweep",
            f"Means per mission under each setting. {caption}",
            "setting",
            [Group(setting, own) for setting, own in settings.items()],
            (count("missions"), *(measure.interval() for measure in SWEPT)),
            (SWEEP_MEANS, *source),
        ),
        tabulate(
            "Sweep, differences",
            f"Paired differences from the nominal setting. {caption}",
            "setting",
            [Group(setting, settings[setting], nominal) for setting in changed if nominal],
            (PAIRS, *(measure.difference() for measure in SWEPT)),
            (SWEEP_DIFFERENCES, *source),
        ),
    ]


def _effects(presets: Mapping[str, Sequence[Row]], advisors: Sequence[str]) -> Table:
    """Make a line for each variant: by how much slower it is than the whole system, in every water with every advisor.

    Without several of these, or without missions that were judged by inspection, there are no lines.
    """
    found = {
        f"{preset}, {advisor}": _by_variant(
            [row for row in own if row["advisor"] in (advisor, NO_ADVISOR) and row["overrides"] == "{}"]
        )
        for preset, own in presets.items()
        for advisor in advisors
    }
    found = {condition: own for condition, own in found.items() if own}
    judged = any(RESTRICTED.of(row) is not None for own in presets.values() for row in own)
    variants = dict.fromkeys(variant for own in found.values() for variant in own if variant != REFERENCE)

    def slower(variant: str, own: Mapping[str, Sequence[Row]]) -> str:
        return RESTRICTED.difference().text(Group(variant, own.get(variant, []), own.get(REFERENCE, [])))

    shown = variants if len(found) > 1 and judged else ()
    lines = tuple((name(variant), *(slower(variant, own) for own in found.values())) for variant in shown)
    what = f"Difference from {name(REFERENCE)} in the time to 90 % inspected (s), {HORIZON_S:.0f} s where never"
    return Table("Effects", f"{what}: above zero is slower.", ("variant", *found), lines, (UNTOLD,))


def word_tables(rows: Sequence[Row], half_of: Callable[[str], str]) -> list[Table]:
    """Make a table of missions in words for each half, `half_of` a world, and water; none without such missions."""
    own = [row for row in rows if row.get("success") is not None and half_of(str(row["world"]))]
    return [
        tabulate("Missions in words", f"The {half} half, {preset} water.", "method", _methods(found), WORDS, WORD_NOTES)
        for half in ("development", "test")
        for preset, found in by_preset([row for row in own if half_of(str(row["world"])) == half]).items()
    ]


def _methods(rows: Sequence[Row]) -> list[Group]:
    oracle_s = {row["world"]: float(row["sim_time_s"]) for row in rows if row["variant"] == "oracle" and row["success"]}
    timed = [
        {**r, "over_oracle": r["sim_time_s"] / oracle_s[r["world"]] if r["world"] in oracle_s else None} for r in rows
    ]
    return [
        Group(variant if advisor == NO_ADVISOR else f"{variant}, {called(advisor)}", own)
        for (variant, advisor), own in group_by(timed, lambda row: (row["variant"], row["advisor"])).items()
    ]


def name(variant: str) -> str:
    """Return a variant's name in the tables."""
    return str(PAPER["names"].get(variant, variant))


def _source(rows: Sequence[Row], advisor: str, about: Mapping[str, Any], command: str) -> tuple[str, ...]:
    chosen = [row for row in rows if row["status"] == "done"]
    seeds = sorted({int(row["seed"]) for row in chosen})
    worlds = list(dict.fromkeys(str(row["world"]) for row in chosen))
    made = made_by(chosen, about, command)
    parts = [f"Worlds: {', '.join(worlds)}. Seeds: {', '.join(map(str, seeds))}. {made}"]
    if len(worlds) < FEW_WORLDS:
        parts.append(f"Few worlds to draw from ({len(worlds)}): intervals are narrower than they should be.")
    parts += [*left_out([row for row in rows if row["status"] == "failed"], _label), *mark_notes(chosen)]
    if any(row["advisor"] == NO_ADVISOR for row in chosen) and advisor != NO_ADVISOR:
        parts.append(
            "Variants without an advisor ran once and appear beside every advisor; their calls are questions "
            "to a rule of their own."
        )
    return tuple(parts)


def _label(row: Row) -> str:
    setting = "" if row["overrides"] == "{}" else f", {setting_text(row['overrides'])}"
    return f"{row['variant']} in {row['world']}, seed {row['seed']}{setting}"
