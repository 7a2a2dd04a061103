"""Each variant of a campaign against `full`, trial by trial: the same task, seed and conditions."""

from __future__ import annotations

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
            "slower in, of both",
            "p of it",
            "requests a trial",
        ),
        tuple((name(variant), *_line(trials, full, variant == REFERENCE)) for variant, trials in by_variant.items()),
        (
            f"Better : worse: trials that only {name(REFERENCE)} solved, and only the method; p: two-sided sign test "
            "of these. Slower in, of both: trials in which the method took longer, of those that both solved, with the "
            "sign test's p.",
            *source,
        ),
    )


def _line(trials: Trials, full: Trials, is_reference: bool) -> tuple[str, ...]:
    won = sum(bool(row["success"]) for row in trials.values())
    low, high = wilson(won, len(trials))
    requests = [float(row["advisor_calls"]) for row in trials.values() if row.get("advisor_calls") is not None]
    begin = (f"{won}/{len(trials)}", f"{number(100 * low, 0)}–{number(100 * high, 0)}")
    end = number(fmean(requests), 1) if requests else "–"
    pairs = [(full[key], row) for key, row in trials.items() if key in full]
    if is_reference or not pairs:
        return (*begin, "–", "–", "–", "–", end)
    better = sum(bool(ours["success"]) and not row["success"] for ours, row in pairs)
    worse = sum(bool(row["success"]) and not ours["success"] for ours, row in pairs)
    both = [(ours, row) for ours, row in pairs if ours["success"] and row["success"]]
    later_s = [float(row["sim_time_s"]) - float(ours["sim_time_s"]) for ours, row in both]
    slower, faster = sum(late > 0 for late in later_s), sum(late < 0 for late in later_s)
    solved = (f"{better} : {worse}", f"{sign_test(better, worse):.2g}")
    return (*begin, *solved, f"{slower} of {len(both)}", f"{sign_test(slower, faster):.2g}", end)
