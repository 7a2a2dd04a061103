"""How a campaign's tables are described: measures of an episode, columns of them, and a line for each group."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from statistics import median
from typing import Any

from coral.campaign.stats import bootstrap_mean, paired_difference, wilson
from coral.campaign.table import Table
from coral.foreign_file import parse_json

Row = Mapping[str, Any]
"""An episode of the data set."""
Pair = tuple[Hashable, Hashable]
MARK = " §"
"""Mark of a line in which a fallback decided; the paper's own tables use † and ‡."""


@dataclass(frozen=True)
class Group:
    """A line of a table: episodes, and what they stand beside."""

    name: str
    rows: Sequence[Row]
    reference: Sequence[Row] = ()
    """Episodes that differences are taken from."""
    printed: Mapping[str, str] = field(default_factory=dict)
    """The paper's numbers by the key of their measure."""


@dataclass(frozen=True)
class Column:
    """A column of a table: its head, and the text of a group."""

    label: str
    text: Callable[[Group], str]


@dataclass(frozen=True)
class Measure:
    """A number of an episode, None if it is undefined, and the columns that show it."""

    key: str
    label: str
    of: Callable[[Row], float | None]
    digits: int = 1

    def mean(self) -> Column:
        """Return the column of means: `97.1`, or `97.1 (28/30)` if only 28 of 30 episodes have the number."""
        return Column(self.label, self._mean_text)

    def interval(self) -> Column:
        """Return the column of means with their intervals: `97.1 [95.0, 99.0]`."""
        return Column(self.label, partial(self._mean_text, interval=True))

    def difference(self) -> Column:
        """Return the column of paired differences from the reference: `−3.1 [−5.0, −1.2]`.

        `≈` is in front if the interval contains zero.
        """
        return Column(f"Δ {self.label}", self._difference_text)

    def median(self) -> Column:
        """Return the column of medians."""

        def text(group: Group) -> str:
            found = self._values(group.rows)
            return number(median(found.values()), self.digits) if found else "–"

        return Column(self.label, text)

    def change(self) -> Column:
        """Return the column of the median's change against the reference's (%)."""

        def text(group: Group) -> str:
            ours, theirs = self._values(group.rows), self._values(group.reference)
            if not ours or not theirs or not median(theirs.values()):
                return "–"
            return number(100.0 * (median(ours.values()) / median(theirs.values()) - 1.0), 0, sign=True)

        return Column(f"Δ {self.label.partition(' (')[0]} (%)", text)

    def paper(self) -> Column:
        """Return the column of the paper's numbers."""
        return Column("paper", lambda group: group.printed.get(self.key, "–"))

    def _values(self, rows: Sequence[Row]) -> dict[Pair, float]:
        """Return the measure of each episode in which it is defined."""
        return {pair(row): value for row in rows if (value := self.of(row)) is not None}

    def _mean_text(self, group: Group, interval: bool = False) -> str:
        if not group.rows:
            return "not run"
        found = self._values(group.rows)
        estimate = bootstrap_mean(list(found.values()), [world for world, _ in found])
        if not estimate.count:
            return "—"
        share = f" ({estimate.count}/{len(group.rows)})" if estimate.count < len(group.rows) else ""
        text = number(estimate.mean, self.digits) + share
        if not interval or math.isnan(estimate.low):
            return text
        return f"{text} [{number(estimate.low, self.digits)}, {number(estimate.high, self.digits)}]"

    def _difference_text(self, group: Group) -> str:
        ours = self._values(group.rows)
        estimate = paired_difference(ours, self._values(group.reference), {key: key[0] for key in ours})
        if not estimate.count:
            return "—"
        mean, low, high = (
            number(value, self.digits, sign=True) for value in (estimate.mean, estimate.low, estimate.high)
        )
        if math.isnan(estimate.low):
            return mean
        return f"{'' if estimate.tells else '≈ '}{mean} [{low}, {high}]"


def column_measure(key: str, label: str, name: str, scale: float = 1.0, digits: int = 1) -> Measure:
    """Make a measure from a column of the data set, times `scale`."""

    def of(row: Row) -> float | None:
        value = row.get(name)
        return None if value is None else scale * float(value)

    return Measure(key, label, of, digits)


def count(label: str) -> Column:
    """Return the column of the number of episodes."""
    return Column(label, lambda group: str(len(group.rows)))


PAIRS = Column("pairs", lambda group: str(len({pair(row) for row in group.rows} & {pair(r) for r in group.reference})))
WON = Column("success", lambda group: f"{len(successes(group.rows))}/{len(group.rows)}")


def _won_interval(group: Group) -> str:
    low, high = wilson(len(successes(group.rows)), len(group.rows))
    return f"{number(100 * low, 0)}–{number(100 * high, 0)}"


WON_INTERVAL = Column("95 % interval (%)", _won_interval)


def of_successes(column: Column) -> Column:
    """Return the same column over the episodes that succeeded."""

    def text(group: Group) -> str:
        won = successes(group.rows)
        return column.text(replace(group, rows=won)) if won else "–"

    return Column(column.label, text)


def successes(rows: Sequence[Row]) -> list[Row]:
    """Return the episodes that succeeded."""
    return [row for row in rows if row["success"]]


def tabulate(
    name: str, caption: str, by: str, groups: Sequence[Group], columns: Sequence[Column], notes: Sequence[str]
) -> Table:
    """Make a table with a line for each group; `by` says what a group is, such as "variant".

    A line in which a fallback decided is marked.
    """
    lines = [(marked(group.name, group.rows), *(column.text(group) for column in columns)) for group in groups]
    return Table(name, caption, (by, *(column.label for column in columns)), tuple(lines), tuple(notes))


def counts(row: Row, name: str) -> Mapping[str, int]:
    """Return `decided_by` or `answers` of a row, stored as JSON text in a data set; empty for older versions."""
    value = row.get(name) or {}
    found: Mapping[str, int] = parse_json(value) if isinstance(value, str) else value
    return found


def marked(name: str, rows: Sequence[Row]) -> str:
    """Return the name of a line, marked if a fallback decided in one of its episodes."""
    return name + MARK if any(counts(row, "decided_by").get("fallback") for row in rows) else name


def group_by(rows: Sequence[Row], key: Callable[[Row], Any]) -> dict[Any, list[Row]]:
    """Group rows by a key, in the order of its first appearance."""
    found: dict[Any, list[Row]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return found


def pair(row: Row) -> Pair:
    """Return the key by which two rows are compared, within one advisor and one configuration: world and seed."""
    return row["world"], row["seed"]


def number(value: float, digits: int, *, sign: bool = False) -> str:
    """Format a number with a real minus; zero has no sign."""
    text = f"{value:+.{digits}f}" if sign else f"{value:.{digits}f}"
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("+-")
    return text.replace("-", "−")
