"""Table 1 of the CoRAL paper from a campaign's rows beside its numbers, trials in pairs, and the strategy ablation."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from coral.campaign.columns import (
    WON,
    WON_INTERVAL,
    Column,
    Group,
    Measure,
    Row,
    column_measure,
    group_by,
    of_successes,
    pair,
    successes,
    tabulate,
)
from coral.campaign.decided import advisors, decided_table, left_out, made_by, mark_notes, share
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.stats import sign_test
from coral.campaign.table import Table
from coral.foreign_file import parse_json, read_json

REFERENCE = "full"


def _with_thinking(row: Row) -> float | None:
    return float(row.get("time_with_thinking_s") or row["sim_time_s"])


def _ends(group: Group) -> str:
    ends = Counter(str(row["end_reason"]) for row in group.rows if not row["success"])
    return ", ".join(f"{reason} {count}" for reason, count in ends.most_common()) or "–"


SIMULATED = column_measure("time", "time (s)", "sim_time_s")
WALL = column_measure("wall_time", "wall time (s)", "wall_time_s")
REQUESTS = column_measure("requests", "requests", "advisor_calls")
EVERY_TASK = (
    WON,
    WON_INTERVAL,
    of_successes(SIMULATED.mean()),
    of_successes(Measure("thinking", "with thinking (s)", _with_thinking).mean()),
    of_successes(WALL.mean()),
    column_measure("path", "path (m)", "path_length_m", digits=2).mean(),
    column_measure("force", "peak force (N)", "peak_hand_force_n").mean(),
    column_measure("plan", "ms per plan", "plan_ms_median", digits=0).median(),
    share("advisor").mean(),
    share("fallback").mean(),
    Column("otherwise ended by", _ends),
)
ABLATION = ("full", "no-regions", "unguided")
"""With a contact strategy; its plan with unguided samples; without."""
STEPS = column_measure("steps", "steps", "steps", digits=0)
PATH = column_measure("path", "path (m)", "path_length_m", digits=2)
TOUCH = column_measure("touch", "first touch (s)", "first_touch_s", digits=2)
ABLATED = (
    WON,
    *(column for measure in (STEPS, PATH) for column in (measure.median(), measure.change(), measure.paper())),
    TOUCH.median(),
    TOUCH.change(),
    column_measure("cost", "planning cost", "plan_cost", digits=2).median(),
    column_measure("jumps", "its jumps", "plan_cost_jump", digits=3).median(),
)


PAPER: dict[str, Any] = read_json(Path(__file__).parent / "contact_paper.json", "a file of this package")
"""The paper's numbers and names."""


def contact_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make all tables, one set for each evaluation world and each advisor among the rows, whose `world` is the task.

    `about` are the conditions of the campaign: commit, machine.
    """
    tables: list[Table] = []
    for place, there in group_by(rows, _place).items():
        for advisor in advisors(rows):
            here = [row for row in there if row["advisor"] in (advisor, NO_ADVISOR)]
            chosen = [row for row in here if row["status"] == "done"]
            source = _source(chosen, [row for row in here if row["status"] == "failed"], about, command)
            caption = f"World: {place}. Advisor: {called(advisor)}."
            tables += [make(chosen, caption, source) for make in (_success, _times, _every_task, _pairs, _decided)]
            tables += _ablations(chosen, caption, source)
    return [table for table in tables if table.rows]


def _place(row: Row) -> str:
    """Return the evaluation world of a trial; a failed one has only the requested world."""
    return str(parse_json(row["overrides"])["world"])


def _success(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Count the successful trials, beside the paper's out of ten."""

    def cell(own: Group) -> str:
        return WON.text(own) if own.rows else "not run"

    what = f"Successful trials beside the paper’s. {caption}"
    return _table_1(rows, "success", "", what, cell, lambda printed: f"{printed[0]}/10", source)


def _times(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Return the mean completion time of the successes: simulated and wall seconds, beside the paper's."""

    def cell(own: Group) -> str:
        won = successes(own.rows)
        return "{} ({})".format(*(m.mean().text(Group("", won)) for m in (SIMULATED, WALL))) if won else "–"

    def theirs(printed: Sequence[int | None]) -> str:
        return "–" if printed[1] is None else str(printed[1])

    what = f"Mean completion time of the successes: simulated seconds (wall seconds). {caption}"
    return _table_1(rows, "time", " (s)", what, cell, theirs, source)


def _table_1(
    rows: Sequence[Row],
    what: str,
    unit: str,
    caption: str,
    cell: Callable[[Group], str],
    theirs: Callable[[Sequence[int | None]], str],
    source: tuple[str, ...],
) -> Table:
    """Make a part of Table 1: a line for each method, ours and the paper's cell for each task, with its unit.

    `cell` returns ours of a method's trials of a task, `theirs` the paper's from its successes and seconds.
    """
    tasks, by_variant = list(PAPER["tasks"]), group_by(rows, lambda row: row["variant"])
    groups = []
    for variant in dict.fromkeys((*PAPER["1"], *by_variant)):
        printed = dict(zip(tasks, map(theirs, PAPER["1"].get(variant, ())), strict=False))
        groups.append(Group(_name(variant), by_variant.get(variant, []), printed=printed))
    columns = []
    for task in sorted(group_by(rows, lambda row: row["world"]), key=lambda t: tasks.index(t) if t in tasks else 99):
        columns.append(Column(f"{PAPER['tasks'].get(task, short_name(task))}{unit}", partial(_of_task, task, cell)))
        columns.append(Measure(task, "", lambda row: None).paper())
    return tabulate(f"Table 1, {what}", caption, "method", groups, columns, (*PAPER["notes"], *source))


def _of_task(task: str, cell: Callable[[Group], str], group: Group) -> str:
    return cell(Group(group.name, [row for row in group.rows if row["world"] == task]))


def _every_task(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Make a line for each variant and task."""
    groups = [
        Group(f"{_name(variant)}, {short_name(task)}", own)
        for (variant, task), own in group_by(rows, lambda row: (row["variant"], row["world"])).items()
    ]
    note = "Times: means over successes; path and force: over all trials. Interval: Wilson’s, of the success rate."
    return tabulate(
        "Every task", f"Trials of each task. {caption}", "method, task", groups, EVERY_TASK, (note, *source)
    )


def _pairs(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Compare the variants with `full`, trial by trial; without it, or without another, there are no lines."""
    by_variant = group_by(rows, lambda row: row["variant"])
    full = by_variant.get(REFERENCE, [])
    groups = [
        Group(_name(variant), own, full if variant != REFERENCE else ())
        for variant, own in by_variant.items()
        if full and len(by_variant) > 1
    ]
    columns = (
        WON,
        WON_INTERVAL,
        Column("better : worse", partial(_counted, _solved)),
        Column("p", partial(_tested, _solved)),
        Column("sooner : later", partial(_counted, _solved_soon)),
        Column("p", partial(_tested, _solved_soon)),
        REQUESTS.mean(),
        of_successes(SIMULATED.mean()),
    )
    note = (
        f"Better : worse: trials that only {_name(REFERENCE)} solved, and only the method. Sooner : later: trials "
        f"that {_name(REFERENCE)} solved sooner than the method, and later; a failure is later than any success. p: "
        "two-sided sign tests. Requests: per trial; time: mean of the successes, simulated."
    )
    what = f"Trial by trial, the same task and seed. {caption}"
    return tabulate(f"Against {_name(REFERENCE)}", what, "method", groups, columns, (note, *source))


def _solved(row: Row) -> float:
    return float(row["success"])


def _solved_soon(row: Row) -> float:
    return -float(row["sim_time_s"]) if row["success"] else -math.inf


def _better(of: Callable[[Row], float], group: Group) -> tuple[int, int] | None:
    """Count the trials of one task and seed that the reference did better, and the group; None without such trials."""
    full = {pair(row): of(row) for row in group.reference}
    both = [(full[pair(row)], of(row)) for row in group.rows if pair(row) in full]
    return (sum(a > b for a, b in both), sum(b > a for a, b in both)) if both else None


def _counted(of: Callable[[Row], float], group: Group) -> str:
    counts = _better(of, group)
    return "{} : {}".format(*counts) if counts else "–"


def _tested(of: Callable[[Row], float], group: Group) -> str:
    counts = _better(of, group)
    return f"{sign_test(*counts):.2g}" if counts else "–"


def _decided(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    groups = [Group(_name(variant), own) for variant, own in group_by(rows, lambda row: row["variant"]).items()]
    note = "Experts and served policies ask no advisor."
    return decided_table(groups, caption, (note, *source), runs="trials")


def _ablations(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> list[Table]:
    """Make the contact-strategy ablation (section 4.1.4, Fig. 5) of each task that ran with a strategy and without."""
    tables = []
    for task, own in group_by([row for row in rows if row["variant"] in ABLATION], lambda row: row["world"]).items():
        by_variant = group_by(own, lambda row: row["variant"])
        seeds = set.intersection(*({row["seed"] for row in found} for found in by_variant.values()))
        shared = {v: [row for row in by_variant.get(v, []) if row["seed"] in seeds] for v in ABLATION}
        without = shared["unguided"]
        if not shared["full"] or not without:
            continue
        printed = PAPER["ablation"] if task == PAPER["ablation"]["task"] else {}
        groups = [
            Group(_name(variant), found, without if variant != "unguided" else (), printed.get(variant, {}))
            for variant, found in shared.items()
            if found
        ]
        notes = (
            "Medians over the seeds that all of them have; a failed trial counts all its steps. Δ: of the median, "
            f"against {_name('unguided')}, whose cost is of outcomes alone. Planning cost: mean expected cost of a "
            "trial's plans, no comparison between different costs; its jumps: mean change from one plan to the next in "
            "a stage. First touch: of the hand on an object, of the trials that have one.",
            f"Seeds: {', '.join(map(str, sorted(seeds)))}. The paper's object poses are the true ones.",
        )
        what = f"{short_name(task)}. {caption}"
        tables.append(tabulate("Contact-strategy ablation", what, "method", groups, ABLATED, (*notes, *source)))
    return tables


def short_name(task: str) -> str:
    """Return a task's name, or its file's without folder and extension; a benchmark's scene keeps its whole name."""
    return task if ":" in task else Path(task).stem


def _name(variant: str) -> str:
    return str(PAPER["names"].get(variant, variant))


def _source(chosen: Sequence[Row], failed: Sequence[Row], about: Mapping[str, Any], command: str) -> tuple[str, ...]:
    seeds = sorted({int(row["seed"]) for row in chosen})
    poses = ", ".join(sorted({_poses(row) for row in chosen}))
    made = made_by(chosen, about, command)
    parts = [f"Seeds: {', '.join(map(str, seeds))}. Object poses: {poses}. {made}"]
    remembering = [row for row in chosen if row.get("memory_known") is not None]
    if remembering:
        known = sorted({int(row["memory_known"]) for row in remembering})
        used = sum(bool(row["memory_hit"]) for row in remembering)
        parts.append(
            f"Experiences in memory at the start of every trial: {', '.join(map(str, known))} (0: nothing can "
            f"be recalled); used in {used} of {len(remembering)} trials."
        )
    names = left_out(failed, lambda row: f"{row['variant']} in {short_name(row['world'])}, seed {row['seed']}")
    return (*parts, *mark_notes(chosen), *names)


def _poses(row: Row) -> str:
    """Return the source of a trial's object poses; a tracker is named unless it is the embedded one."""
    embedded = row.get("tracker") in (None, "", "model")
    return str(row.get("poses")) if embedded else f"{row.get('poses')} ({row['tracker']})"
