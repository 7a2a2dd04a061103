"""Table of who decided: shares of the advisor and the fallback, and the cost of the answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from statistics import fmean
from typing import Any

from coral.advisor.attribution import FATES, SOURCES, Source
from coral.campaign.measures import Measure, Row, field, number
from coral.campaign.table import Table
from coral.foreign_file import parse_json

MARK = " §"
"""Mark of a row in which a fallback decided; the paper's own tables use † and ‡."""

COSTS = (
    field("tokens_in", "tokens in", "tokens_in", digits=0),
    field("tokens_out", "tokens out", "tokens_out", digits=0),
    field("cost", "cost (USD)", "cost_usd", digits=4),
    field("thinking", "thinking (s)", "thinking_s"),
)


def counts(row: Row, name: str) -> Mapping[str, int]:
    """Return `decided_by` or `answers` of a row, stored as JSON text in a data set; empty for older versions."""
    value = row.get(name) or {}
    found: Mapping[str, int] = parse_json(value) if isinstance(value, str) else value
    return found


def share(source: Source) -> Measure:
    """Return the share of an episode's decisions that a source made, in percent; None without any."""

    def of(row: Row) -> float | None:
        by = counts(row, "decided_by")
        total = sum(by.values())
        return 100.0 * by.get(source, 0) / total if total else None

    return Measure(f"by_{source}", f"by {source} (%)", of)


def marked(name: str, rows: Sequence[Row]) -> str:
    """Return the name of a row, marked if a fallback decided in one of its episodes."""
    return name + MARK if any(counts(row, "decided_by").get("fallback") for row in rows) else name


def mark_notes(rows: Sequence[Row]) -> tuple[str, ...]:
    """Explain the mark in a table of these rows; nothing if no fallback decided."""
    notes = []
    for policy in sorted({str(row.get("fallback", "")) for row in rows}):
        own = [row for row in rows if str(row.get("fallback", "")) == policy]
        total, fell = sum(map(_all, own)), sum(map(_fallback_count, own))
        if not fell:
            continue
        what = (
            "were made by the fallback’s rules, so these rows are not the advisor’s alone"
            if policy == "rules"
            else "were left undecided: prior beliefs, no regions or the plan before stood"
            if policy == "prior"
            else "were left undecided by the advisor; the consequences count as its own"
        )
        notes.append(f"§: {fell} of {total} decisions {what} (fallback: {policy or 'unknown'}).")
    return tuple(notes)


def made_by(chosen: Sequence[Row], about: Mapping[str, Any], command: str) -> str:
    """Describe the code, the machine and the command that made these rows; mixed versions are told."""
    versions = sorted({str(row.get("code")) for row in chosen})
    mixed = " Mixed: they ran on different versions of the code." if len(versions) > 1 else ""
    commit, machine = about.get("commit", "unknown"), about.get("machine", "?")
    return f"Commit {commit} (code {', '.join(versions)}), {machine}. Made by: {command}{mixed}"


def left_out(failed: Sequence[Row], name: Callable[[Row], str]) -> tuple[str, ...]:
    """Name the first rows that failed; nothing without any."""
    names, more = ", ".join(name(row) for row in failed[:4]), ", …" if len(failed) > 4 else ""
    return (f"Failed and left out ({len(failed)}): {names}{more}.",) if failed else ()


def decided_table(groups: Mapping[str, Sequence[Row]], caption: str, notes: tuple[str, ...], *, runs: str) -> Table:
    """Make a row for each group of episodes: who decided, the fate of the answers, tokens, cost and thinking time.

    Args:
        groups: Finished episodes by the name of their row.
        caption: Caption of the table.
        notes: Notes after the explanation of the columns; with `mark_notes`.
        runs: The word for episodes, in the plural.
    """
    everything = [row for rows in groups.values() for row in rows]
    sources = [s for s in SOURCES if s in ("advisor", "fallback") or _total(everything, "decided_by", s)]
    lines = []
    for name, rows in groups.items():
        total = sum(map(_all, rows))
        shares = [_part(_total(rows, "decided_by", source), total) for source in sources]
        fates = [number(_total(rows, "answers", fate) / len(rows), 1) if rows else "—" for fate in FATES]
        lines.append(
            (
                marked(name, rows),
                str(len(rows)),
                str(total),
                *shares,
                *fates,
                *(_mean(rows, measure) for measure in COSTS),
            )
        )
    return Table(
        "Who decided",
        caption,
        (
            "variant",
            runs,
            "decisions",
            *(f"by {source}" for source in sources),
            *FATES,
            *(measure.label for measure in COSTS),
        ),
        tuple(lines),
        (
            f"Decisions are counted over all {runs}; answers, tokens, cost and thinking are means of the {runs}. "
            "Missing: no reply. “—”: unknown for at least one of them.",
            *notes,
        ),
    )


def _all(row: Row) -> int:
    return sum(counts(row, "decided_by").values())


def _fallback_count(row: Row) -> int:
    return counts(row, "decided_by").get("fallback", 0)


def _total(rows: Sequence[Row], name: str, key: str) -> int:
    return sum(counts(row, name).get(key, 0) for row in rows)


def _part(count: int, total: int) -> str:
    return f"{count} ({100.0 * count / total:.0f} %)" if total else "—"


def _mean(rows: Sequence[Row], measure: Measure) -> str:
    """Return the mean of a cost; a dash if it is unknown for one of the episodes."""
    values: list[Any] = [measure.of(row) for row in rows]
    return number(fmean(values), measure.digits) if values and None not in values else "—"
