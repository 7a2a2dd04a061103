"""Who decided, and what it cost: columns, and the notes about origin and fallback under every table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from coral.advisor.attribution import FATES, SOURCES, Source
from coral.campaign.columns import Column, Group, Measure, Row, column_measure, count, counts, tabulate
from coral.campaign.spec import NO_ADVISOR
from coral.campaign.table import Table

COSTS = (
    column_measure("tokens_in", "tokens in", "tokens_in", digits=0),
    column_measure("tokens_out", "tokens out", "tokens_out", digits=0),
    column_measure("cost", "cost (USD)", "cost_usd", digits=4),
    column_measure("thinking", "thinking (s)", "thinking_s"),
)


FELL = {
    "rules": "were made by the fallback’s rules, so these rows are not the advisor’s alone",
    "prior": "were left undecided: prior beliefs, no regions or the plan before stood",
}
"""What became of decisions that the advisor did not make, by the fallback."""


def advisors(rows: Sequence[Row]) -> list[str]:
    """Return the advisors of these rows, each once."""
    return list(dict.fromkeys(row["advisor"] for row in rows if row["advisor"] != NO_ADVISOR)) or [NO_ADVISOR]


def share(source: Source) -> Measure:
    """Return the share of an episode's decisions that a source made, in percent; None without any."""

    def of(row: Row) -> float | None:
        total = _decisions(row)
        return 100.0 * _by(source, row) / total if total else None

    return Measure(f"by_{source}", f"by {source} (%)", of)


def decided_table(groups: Sequence[Group], caption: str, notes: Sequence[str], *, runs: str) -> Table:
    """Make a line for each group of finished episodes: who decided, the fate of the answers, tokens, cost and time.

    The notes, with `mark_notes`, follow the explanation of the columns; `runs` is the word for episodes, in the plural.
    """
    everything = [row for group in groups for row in group.rows]
    sources = [s for s in SOURCES if s in ("advisor", "fallback") or any(_by(s, row) for row in everything)]
    columns = (
        count(runs),
        Column("decisions", lambda group: str(sum(map(_decisions, group.rows)))),
        *(Column(f"by {source}", partial(_part, source)) for source in sources),
        *(Measure(fate, fate, partial(_fate, fate)).mean() for fate in FATES),
        *(cost.mean() for cost in COSTS),
    )
    told = (
        f"Decisions are counted over all {runs}; answers, tokens, cost and thinking are means of the {runs}. "
        "Missing: no reply. “—”: unknown."
    )
    return tabulate("Who decided", caption, "variant", groups, columns, (told, *notes))


def mark_notes(rows: Sequence[Row]) -> tuple[str, ...]:
    """Explain the mark in a table of these rows; nothing if no fallback decided."""
    notes = []
    for policy in sorted({str(row.get("fallback", "")) for row in rows}):
        own = [row for row in rows if str(row.get("fallback", "")) == policy]
        total, fell = sum(map(_decisions, own)), sum(_by("fallback", row) for row in own)
        if not fell:
            continue
        what = FELL.get(policy, "were left undecided by the advisor; the consequences count as its own")
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


def _decisions(row: Row) -> int:
    return sum(counts(row, "decided_by").values())


def _by(source: str, row: Row) -> int:
    return counts(row, "decided_by").get(source, 0)


def _fate(fate: str, row: Row) -> float:
    return float(counts(row, "answers").get(fate, 0))


def _part(source: str, group: Group) -> str:
    made, total = sum(_by(source, row) for row in group.rows), sum(map(_decisions, group.rows))
    return f"{made} ({100.0 * made / total:.0f} %)" if total else "—"
