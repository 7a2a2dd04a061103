"""Table 1 of the CoRAL paper from a campaign's rows, beside the paper's own numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from statistics import fmean, median
from typing import Any

from coral.campaign.contact_pairs import paired_table
from coral.campaign.decided import decided_table, left_out, made_by, mark_notes, marked, share
from coral.campaign.measures import Row, mean_text, number
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.stats import wilson
from coral.campaign.table import Table
from coral.foreign_file import parse_json, read_json

SHARES = (share("advisor"), share("fallback"))


@cache
def paper() -> dict[str, Any]:
    """Load the paper's numbers and names."""
    content: dict[str, Any] = read_json(Path(__file__).parent / "contact_paper.json", "a file of this package")
    return content


def contact_tables(rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
    """Make all tables, one set for each evaluation world and each advisor among the rows.

    Args:
        rows: Rows of the data set; `world` is the task, `evaluation_world` its world.
        about: Conditions of the campaign: commit, machine.
        command: The command that makes the tables.
    """
    advisors = list(dict.fromkeys(row["advisor"] for row in rows if row["advisor"] != NO_ADVISOR)) or [NO_ADVISOR]
    tables: list[Table] = []
    for place in dict.fromkeys(map(_place, rows)):
        for advisor in advisors:
            here = [row for row in rows if _place(row) == place and row["advisor"] in (advisor, NO_ADVISOR)]
            chosen = [row for row in here if row["status"] == "done"]
            failed = [row for row in here if row["status"] == "failed"]
            source = _source(chosen, failed, about, command)
            caption = f"World: {place}. Advisor: {called(advisor)}."
            tables += [make(chosen, caption, source) for make in (_success, _times, _trials_table)]
            paired = paired_table(chosen, caption, source, _name)
            tables += [*([] if paired is None else [paired]), _decided(chosen, caption, source)]
    return tables


def _place(row: Row) -> str:
    """Return the evaluation world of a trial; a failed one has only the requested world."""
    return str(parse_json(row["overrides"])["world"])


def poses_of(rows: Sequence[Row]) -> str:
    """Return the source of the trials' object poses; a tracker is named unless it is the embedded one."""
    return ", ".join(
        sorted(
            {
                f"{row.get('poses')} ({row['tracker']})"
                if row.get("tracker") not in (None, "", "model")
                else str(row.get("poses"))
                for row in rows
            }
        )
    )


def _success(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Count the successful trials, beside the paper's out of ten."""

    def cells(own: Sequence[Row], printed: list[int | None] | None) -> tuple[str, str]:
        ours = f"{sum(map(_is_success, own))}/{len(own)}" if own else "not run"
        return ours, f"{printed[0]}/10" if printed else "–"

    return _beside_paper(rows, cells, "success", "", f"Successful trials beside the paper’s. {caption}", source)


def _times(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Return the mean completion time of the successes: simulated and wall seconds, beside the paper's."""

    def cells(own: Sequence[Row], printed: list[int | None] | None) -> tuple[str, str]:
        won = [row for row in own if _is_success(row)]
        simulated, wall = (_mean([row[key] for row in won]) for key in ("sim_time_s", "wall_time_s"))
        theirs = "–" if printed is None or printed[1] is None else str(printed[1])
        return f"{simulated} ({wall})" if won else "–", theirs

    what = f"Mean completion time of the successes: simulated seconds (wall seconds). {caption}"
    return _beside_paper(rows, cells, "time", " (s)", what, source)


def _beside_paper(
    rows: Sequence[Row],
    cells: Callable[[Sequence[Row], list[int | None] | None], tuple[str, str]],
    what: str,
    unit: str,
    caption: str,
    source: tuple[str, ...],
) -> Table:
    """Make a part of Table 1: for each method and task our cell and the paper's.

    Args:
        rows: Trials.
        cells: Returns both cells of a method's trials of a task, given the paper's numbers.
        what: What the part shows.
        unit: Its unit, after the name of a task.
        caption: Caption of the table.
        source: Notes on where the rows come from.
    """
    tasks = _tasks(rows)
    lines = [
        (
            _marked(variant, rows),
            *(cell for task in tasks for cell in cells(_of(rows, variant, task), _paper_numbers(variant, task))),
        )
        for variant in _variants(rows)
    ]
    header = ("method", *(label for task in tasks for label in (f"{_task(task)}{unit}", "paper")))
    return Table(f"Table 1, {what}", caption, header, tuple(lines), (*paper()["notes"], *source))


def _trials_table(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Make a line for each variant and task."""
    lines = []
    for variant in dict.fromkeys(str(row["variant"]) for row in rows):
        for task in _tasks(rows):
            own = _of(rows, variant, task)
            if not own:
                continue
            won = [row for row in own if _is_success(row)]
            low, high = wilson(len(won), len(own))
            ends = Counter(str(row["end_reason"]) for row in own if not _is_success(row))
            lines.append(
                (
                    marked(f"{_name(variant)}, {short_name(task)}", own),
                    f"{len(won)}/{len(own)}",
                    f"{number(100 * low, 0)}–{number(100 * high, 0)}",
                    _mean([row["sim_time_s"] for row in won]),
                    _mean([row.get("time_with_thinking_s") or row["sim_time_s"] for row in won]),
                    _mean([row["wall_time_s"] for row in won]),
                    _mean([row["path_length_m"] for row in own], 2),
                    _mean([row["peak_hand_force_n"] for row in own]),
                    number(median(float(row["plan_ms_median"]) for row in own), 0),
                    *(mean_text(own, measure) for measure in SHARES),
                    ", ".join(f"{reason} {count}" for reason, count in ends.most_common()) or "–",
                )
            )
    return Table(
        "Every task",
        f"Trials of each task. {caption}",
        (
            "method, task",
            "success",
            "95 % interval (%)",
            "time (s)",
            "with thinking (s)",
            "wall time (s)",
            "path (m)",
            "peak force (N)",
            "ms per plan",
            *(measure.label for measure in SHARES),
            "otherwise ended by",
        ),
        tuple(lines),
        (
            "Times: means over successes; path and force: over all trials. Interval: Wilson’s, of the success rate.",
            *source,
        ),
    )


def _decided(rows: Sequence[Row], caption: str, source: tuple[str, ...]) -> Table:
    """Make the table of who decided, for each variant that asks an advisor."""
    groups = {
        _name(variant): [row for row in rows if row["variant"] == variant]
        for variant in dict.fromkeys(str(row["variant"]) for row in rows)
    }
    note = "Experts and served policies ask no advisor."
    return decided_table(groups, caption, (note, *source), runs="trials")


def _is_success(row: Row) -> bool:
    return bool(row["success"])


def _of(rows: Sequence[Row], variant: str, task: str) -> list[Row]:
    return [row for row in rows if (row["variant"], row["world"]) == (variant, task)]


def _tasks(rows: Sequence[Row]) -> list[str]:
    """Return the tasks that were run, the paper's first and in its order."""
    there = dict.fromkeys(str(row["world"]) for row in rows)
    known = list(paper()["tasks"])
    return [task for task in known if task in there] + [task for task in there if task not in known]


def _variants(rows: Sequence[Row]) -> list[str]:
    """Return the paper's rows in its order, then our additional ones."""
    return [*paper()["1"], *dict.fromkeys(str(row["variant"]) for row in rows if row["variant"] not in paper()["1"])]


def _paper_numbers(variant: str, task: str) -> list[int | None] | None:
    tasks = list(paper()["tasks"])
    if variant not in paper()["1"] or task not in tasks:
        return None
    cell: list[int | None] = paper()["1"][variant][tasks.index(task)]
    return cell


def short_name(task: str) -> str:
    """Return a task's name, or its file's without folder and extension; a benchmark's scene keeps its whole name."""
    return task if ":" in task else Path(task).stem


def _task(task: str) -> str:
    return str(paper()["tasks"].get(task, short_name(task)))


def _name(variant: str) -> str:
    return str(paper()["names"].get(variant, variant))


def _marked(variant: str, rows: Sequence[Row]) -> str:
    """Return the name of a variant, marked if a fallback decided in one of its trials."""
    return marked(_name(variant), [row for row in rows if row["variant"] == variant])


def _mean(values: Sequence[float], digits: int = 1) -> str:
    return number(fmean(float(value) for value in values), digits) if values else "–"


def _source(chosen: Sequence[Row], failed: Sequence[Row], about: Mapping[str, Any], command: str) -> tuple[str, ...]:
    """Describe how the table was made."""
    seeds = sorted({int(row["seed"]) for row in chosen})
    made = made_by(chosen, about, command)
    parts = [f"Seeds: {', '.join(map(str, seeds))}. Object poses: {poses_of(chosen)}. {made}"]
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
