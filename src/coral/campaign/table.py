"""A table as data, and its rendering as Markdown and HTML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Table:
    """A table of text; the first column is left-aligned, the others are right-aligned."""

    name: str
    """Short name, such as "Table I"."""
    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    """Sentences under the table."""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.header):
                raise ValueError(f"{self.name}: a row of {len(row)} cells under a header of {len(self.header)}")


def table_json(table: Table) -> dict[str, Any]:
    """Return a table as plain values, its rows by column name; a `paper` column is named after its neighbour."""
    head = table.header
    names = [f"{head[k - 1]}, paper" if label == "paper" else label for k, label in enumerate(head)]
    return {
        "name": table.name,
        "caption": table.caption,
        "rows": [dict(zip(names, row, strict=True)) for row in table.rows],
        "notes": list(table.notes),
    }


def to_markdown(table: Table) -> str:
    """Render GitHub's Markdown, padded so that it reads as plain text too."""
    cells = [[cell.replace("|", r"\|") for cell in row] for row in (table.header, *table.rows)]
    widths = [max(3, *(len(row[k]) for row in cells)) for k in range(len(table.header))]
    lines = [f"**{table.name}.** {table.caption}", ""]
    for number, row in enumerate(cells):
        padded = [
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append(f"| {' | '.join(padded)} |")
        if number == 0:
            rule = ["-" * width if k == 0 else "-" * (width - 1) + ":" for k, width in enumerate(widths)]
            lines.append(f"| {' | '.join(rule)} |")
    lines += ["", *(f"- {note}" for note in table.notes)] if table.notes else []
    return "\n".join(lines) + "\n"


def overview(tables: Sequence[Table], first: Sequence[str], at_most: int = 2) -> str:
    """Render what a terminal shows of a campaign: the tables that matter, and their common notes once.

    `first` has beginnings of names by importance, of which `at_most` are shown, each with all tables that share it.
    """
    names = [name for name in first if any(table.name.startswith(name) for table in tables)][:at_most]
    shown = [table for name in names for table in tables if table.name.startswith(name)]
    notes = dict.fromkeys(note for table in shown for note in table.notes)
    rest = len(tables) - len(shown)
    more = [f"({rest} more in the files below)"] if rest > 0 else []
    parts = [to_markdown(replace(table, notes=())) for table in shown]
    return "\n".join([*parts, *(f"- {note}" for note in notes), *more])


def gather_notes(tables: Sequence[Table]) -> tuple[list[Table], list[str]]:
    """Move the notes that several tables share behind the last one; name the tables where they are not for all."""
    under: dict[str, list[str]] = {}
    for table in tables:
        for note in dict.fromkeys(table.notes):
            under.setdefault(note, []).append(table.name)
    shared = {note: names for note, names in under.items() if len(names) > 1}
    own = [replace(table, notes=tuple(n for n in table.notes if n not in shared)) for table in tables]
    told = [
        note if len(names) == len(tables) else f"{note} ({', '.join(dict.fromkeys(names))})"
        for note, names in shared.items()
    ]
    return own, told


def document(tables: Sequence[Table], form: str, title: str) -> str:
    """Render all tables in order as one file of the form `md` or `html`."""
    tables, shared = gather_notes(tables)
    if form == "md":
        last = ["## Notes", "", *(f"- {note}" for note in shared), ""] if shared else []
        return "\n".join([f"# {title}", "", *(to_markdown(table) for table in tables), *last])
    from coral.view.page import render_page

    return render_page("tables.html.j2", title=title, tables=tables, shared=shared)
