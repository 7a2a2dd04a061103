"""Each variant of a campaign against `full`, trial by trial: the same task, seed and conditions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from statistics import fmean

from coral.campaign.measures import Row, number
from coral.campaign.stats import sign_test, wilson
from coral.campaign.table import Table

REFERENCE = "full"
Trials = Mapping[tuple[str, int], Row]


def paired_table(
    rows: Sequence[Row], caption: str, source: tuple[str, ...], name: Callable[[str], str] = str
) -> Table | None:
    """Compare the variants with `full`; None if there is nothing to compare.

    Args:
        rows: Trials that ran to their end, of one world and advisor.
        caption: Ends the table's caption.
        source: Notes on where the rows come from.
        name: Name of a variant.
    """
    by_variant: dict[str, dict[tuple[str, int], Row]] = {}
    for row in rows:
        by_variant.setdefault(str(row["variant"]), {})[str(row["world"]), int(row["seed"])] = row
    full = by_variant.get(REFERENCE)
    if full is None or len(by_variant) == 1:
        return None
    return Table(
        f"Against {name(REFERENCE)}",
        f"Trial by trial, the same task and seed. {caption}",
        (
            "method",
            "success",
            "95 % interval (%)",
            "better : worse",
            "p",
            "sooner : later",
            "p",
            "requests",
            "time (s)",
        ),
        tuple((name(variant), *_line(trials, full, variant == REFERENCE)) for variant, trials in by_variant.items()),
        (
            f"Better : worse: trials that only {name(REFERENCE)} solved, and only the method. Sooner : later: trials "
            f"that {name(REFERENCE)} solved sooner than the method, and later; a failure is later than any success. p: "
            "two-sided sign tests. Requests: per trial; time: mean of the successes, simulated.",
            *source,
        ),
    )


def _line(trials: Trials, full: Trials, is_reference: bool) -> tuple[str, ...]:
    won = sum(bool(row["success"]) for row in trials.values())
    low, high = wilson(won, len(trials))
    requests = [float(row["advisor_calls"]) for row in trials.values() if row.get("advisor_calls") is not None]
    times = [float(row["sim_time_s"]) for row in trials.values() if row["success"]]
    begin = (f"{won}/{len(trials)}", f"{number(100 * low, 0)}–{number(100 * high, 0)}")
    end = tuple(number(fmean(values), 1) if values else "–" for values in (requests, times))
    pairs = [(full[key], row) for key, row in trials.items() if key in full]
    if is_reference or not pairs:
        return (*begin, "–", "–", "–", "–", *end)
    solved = [(bool(ours["success"]), bool(row["success"])) for ours, row in pairs]
    ended = [(_solved_s(ours), _solved_s(row)) for ours, row in pairs]
    return (*begin, *_tested(solved), *_tested([(-ours, -row) for ours, row in ended]), *end)


def _solved_s(row: Row) -> float:
    return float(row["sim_time_s"]) if row["success"] else math.inf


def _tested(pairs: Sequence[tuple[float, float]]) -> tuple[str, str]:
    """Return in how many pairs the first is larger, and the second, and the p value of that."""
    first, second = sum(a > b for a, b in pairs), sum(b > a for a, b in pairs)
    return f"{first} : {second}", f"{sign_test(first, second):.2g}"
