"""The contact-strategy ablation of the CoRAL paper (section 4.1.4, Fig. 5) from a campaign's rows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import median

from coral.campaign.contact_tables import paper, poses_of
from coral.campaign.measures import Row, number
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.table import Table

GUIDED, UNGUIDED = "full", "unguided"
NAMES = {GUIDED: "with contact strategy", "no-regions": "its plan, samples unguided", UNGUIDED: "without"}
COLUMNS = (("steps", 0), ("path_length_m", 2), ("first_touch_s", 2), ("plan_cost", 2), ("plan_cost_jump", 3))
"""Measure and number of decimals."""
COMPARED = ("steps", "path_length_m", "first_touch_s")
"""Measures that can be compared: the variants' costs are different functions."""
HEADER = ("", "success", "steps", "path (m)", "first touch (s)", "planning cost", "its jumps")


def ablations(rows: Sequence[Row], command: str) -> list[Table]:
    """Make a table for each task, evaluation world and advisor that ran both with and without a contact strategy.

    Args:
        rows: Rows of the data set.
        command: The command that makes the tables.
    """
    done = [row for row in rows if row["status"] == "done" and row["advisor"] != NO_ADVISOR and row["variant"] in NAMES]
    keys = dict.fromkeys((str(row["world"]), str(row["evaluation_world"]), str(row["advisor"])) for row in done)
    return [table for key in keys if (table := _table(_chosen(done, *key), *key, command)) is not None]


def _chosen(rows: Sequence[Row], task: str, place: str, advisor: str) -> dict[str, list[Row]]:
    """Select finished trials by variant, of the seeds that all variants have: a paired comparison."""
    own = [
        row
        for row in rows
        if row["status"] == "done" and (row["world"], row["evaluation_world"], row["advisor"]) == (task, place, advisor)
    ]
    seeds = {variant: {int(row["seed"]) for row in own if row["variant"] == variant} for variant in NAMES}
    present = [variant for variant in NAMES if seeds[variant]]
    shared = set.intersection(*(seeds[variant] for variant in present)) if present else set()
    return {
        variant: sorted(
            (row for row in own if row["variant"] == variant and int(row["seed"]) in shared),
            key=lambda row: int(row["seed"]),
        )
        for variant in present
    }


def _table(trials: dict[str, list[Row]], task: str, place: str, advisor: str, command: str) -> Table | None:
    guided, unguided = trials.get(GUIDED), trials.get(UNGUIDED)
    if not guided or not unguided:
        return None
    lines = [_line(NAMES[variant], own) for variant, own in trials.items()]
    lines.append(("change", "", *(_change(guided, unguided, key) for key, _ in COLUMNS)))
    printed = paper()["ablation"]
    if task == printed["task"]:
        lines += [
            (f"paper, {NAMES[variant]}", "–", str(printed[variant][0]), f"{printed[variant][1]:.2f}", *["–"] * 3)
            for variant in (GUIDED, UNGUIDED)
        ]
        lines.append(("paper, change", "", *printed["change"], *["–"] * 3))
    notes = (
        "Medians over all trials; a failed one counts all its steps. Change: of the median with the strategy against "
        "that without.",
        "Without: the cost is of outcomes alone (variant `unguided`, as the paper calls it). Planning cost: mean "
        "expected cost of a trial's plans, no comparison between different costs; its jumps: mean change from one plan "
        "to the next in a stage. First touch: of the hand on an object, of the trials that have one.",
        f"Seeds: {', '.join(str(row['seed']) for row in guided)}. Object poses: {poses_of((*guided, *unguided))} "
        f"(paper: ground truth). Made by: {command}",
    )
    return Table(
        "Contact-strategy ablation",
        f"{Path(task).stem}, world: {place}. Advisor: {called(advisor)}.",
        HEADER,
        tuple(lines),
        notes,
    )


def _line(name: str, rows: Sequence[Row]) -> tuple[str, ...]:
    won = sum(bool(row["success"]) for row in rows)
    return (name, f"{won}/{len(rows)}", *(_median_text(rows, key, digits) for key, digits in COLUMNS))


def _values(rows: Sequence[Row], key: str) -> list[float]:
    return [float(row[key]) for row in rows if row.get(key) is not None]


def _median_text(rows: Sequence[Row], key: str, digits: int) -> str:
    values = _values(rows, key)
    return number(median(values), digits) if values else "–"


def _change(guided: Sequence[Row], unguided: Sequence[Row], key: str) -> str:
    ours, theirs = _values(guided, key), _values(unguided, key)
    if key not in COMPARED or not ours or not theirs or not median(theirs):
        return "–"
    return f"{100.0 * (median(ours) / median(theirs) - 1.0):+.0f} %"
