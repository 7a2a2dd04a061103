"""Self-contained pages: one builder for the reports of surveys, tasks and products."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from coral.file_writer import write_whole, writing
from coral.foreign_file import read_text
from coral.odd_text import encodable
from coral.run_files import RunFiles
from coral.view.run import Record, RunFolder
from coral.words import clock
from coral.yaml_file import to_yaml

TEMPLATES = Path(__file__).parent / "templates"
UNITS = {"m_s": "m/s", "ms": "ms", "s": "s", "mm": "mm", "m": "m", "n": "N", "deg": "°", "usd": "USD"}
NAME = re.compile(rf"(.+?)_({'|'.join(UNITS)})((?:_(?:p\d+|median|max))?)")
"""A metric's name with its unit, at the end or before what is taken of many values."""
SHARES = ("coverage", "imaged", "inspected")
"""Metrics that are read in percent."""


def render_page(template: str, **values: Any) -> str:
    """Render a template that extends `page.html.j2`, and loads nothing from elsewhere; a missing value is an error.

    Every text is escaped unless it is `Markup`.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["clock"] = clock
    style = Markup(read_text(TEMPLATES / "report.css", "a file of this package"))
    return environment.get_template(template).render(style=style, **values)


def write_page(folder: Path, page: str, name: str = RunFiles.REPORT) -> Path:
    """Write a page atomically and return its path.

    Raises:
        InputError: It cannot be written.
    """
    path = folder / name
    with writing(path):
        write_whole(path, encodable(page))
    return path


def metric_rows(metrics: Mapping[str, Any], definitions: Mapping[str, str]) -> list[tuple[str, str, str]]:
    """Return name, value and meaning of every metric but those with a table of their own."""
    return [
        (metric_name(key), metric_text(key, value), _with_code(definitions.get(key, "")))
        for key, value in metrics.items()
        if key != "conditions"
    ]


def _with_code(text: str) -> Markup:
    """Return a text with what stands in backticks as code."""
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def metric_name(key: str) -> str:
    """Return a metric's name in words, with its unit in brackets."""
    if key == "stages":
        return "changes of stage"
    found = NAME.fullmatch(key)
    return (f"{found[1]}{found[3]} ({UNITS[found[2]]})" if found else key).replace("_", " ")


def metric_text(key: str, value: object) -> str:
    """Return a metric's value as it is read."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if key in SHARES and isinstance(value, int | float):
        return f"{value:.1%}"
    if isinstance(value, float):
        return f"{value:,.3f}".rstrip("0").rstrip(".")
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {count}" for name, count in value.items())
    return str(value)


def origin(run: RunFolder, names: Sequence[str], timing: Sequence[str]) -> dict[str, Any]:
    """Return what the last section of a run's page says: provenance and configuration.

    `names` are facts of the run's first event or its configuration, `timing` some of its times.
    """
    start: Record = (run.select("start") or [{}])[0]
    machine = run.config.get("provenance")
    facts = [(name, start.get(name, run.config.get(name))) for name in names]
    facts += list(machine.items()) if isinstance(machine, dict) else []
    facts += [(name, run.timing.get(name)) for name in timing]
    return {
        "provenance": [(metric_name(key), metric_text(key, value)) for key, value in facts if value not in (None, "")],
        "config": to_yaml(dict(run.config)) if run.config else "",
    }
