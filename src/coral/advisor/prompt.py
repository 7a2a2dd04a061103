"""Prompts from template files: one per kind of question, with a version derived from the file."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

from coral.advisor.question import Rejection
from coral.errors import InputError, nearest
from coral.foreign_file import read_text

FOLDER = Path(__file__).parent / "prompts"

_environment = jinja2.Environment(
    loader=jinja2.FileSystemLoader(FOLDER),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    autoescape=False,
    keep_trailing_newline=True,
)


def table(rows: Sequence[Mapping[str, Any]], *without: str) -> str:
    """Show rows with the same keys as a table: a header and a line for each, the cells between bars.

    In JSON every row repeats its keys, and a row of numbers has three times as many tokens.
    """
    keys = [key for key in dict.fromkeys(key for row in rows for key in row) if key not in without]
    lines = [" | ".join(keys), *(" | ".join(_cell(row.get(key)) for key in keys) for row in rows)]
    return "\n".join(lines)


def _cell(value: Any) -> str:
    """Show a value without quotes and brackets, numbers to the third decimal and without a leading zero."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_cell(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        words = any(isinstance(item, str | Mapping) for item in value)
        return (", " if words else " ").join(_cell(item) for item in value)
    if isinstance(value, float):
        shown = f"{round(value, 3) + 0.0:.6g}" if abs(value) < 1e5 else f"{value:.3g}"
        return re.sub(r"^(-?)0\.", r"\1.", shown)
    return "none" if value is None or value == "" else str(value)


_environment.filters["table"] = table
_environment.policies["json.dumps_kwargs"] = {"sort_keys": False, "default": str}


def kinds() -> list[str]:
    """Return the kinds of question that have a template."""
    return sorted(path.stem for path in FOLDER.glob("*.md"))


@cache
def version(kind: str) -> str:
    """Return a template's version: the one in its first line, and a digest of its text, such as "1+3f2a9c04".

    The digest covers the parts that the template includes.

    Raises:
        InputError: There is no such kind, or its first line is not `{# version: N #}`.
    """
    file = FOLDER / f"{kind}.md"
    if kind not in kinds():
        raise InputError("prompt", "kind", repr(kind), f"one of {', '.join(kinds())}{nearest(kind, kinds())}")
    text = read_text(file, "a prompt of this package")
    first = text.partition("\n")[0]
    if not (first.startswith("{# version: ") and first.endswith(" #}")):
        raise InputError(file.name, "line 1", repr(first), "{# version: N #}")
    included = "".join(
        read_text(FOLDER / name, "a file of this package") for name in re.findall(r'{% include "([\w/.-]+)" %}', text)
    )
    return f"{first[12:-3].strip()}+{hashlib.sha256((text + included).encode()).hexdigest()[:8]}"


def render(kind: str, context: Mapping[str, Any] | None = None, /, **more: Any) -> tuple[str, str]:
    """Render the template of one kind of question, such as "reef-centroid", with the values of its placeholders.

    Raises:
        InputError: There is no such kind, or a placeholder has no value.
    """
    stamp = version(kind)
    try:
        text = _environment.get_template(f"{kind}.md").render(**{**(context or {}), **more})
    except jinja2.UndefinedError as error:
        raise InputError(
            f"prompt {kind}", "", error.message or "a missing value", "a value for every placeholder"
        ) from None
    return text.strip() + "\n", stamp


def render_rejections(rejections: Sequence[Rejection]) -> str:
    """Render why earlier answers were refused, as the last part of a prompt; "" if none was.

    Advisors add this themselves; a template does not need it.
    """
    if not rejections:
        return ""
    lines = []
    for number, rejection in enumerate(rejections, start=1):
        lines.append(f"{number}. {rejection.reason}")
        if rejection.listing and number == len(rejections):  # earlier programs would only fill the prompt
            lines += ["The refused program:", "```", rejection.listing, "```"]
    return "\n".join(
        [
            "Earlier answers to this question were checked and refused, for these reasons:",
            *lines,
            "Give a different answer that none of these reasons applies to.",
        ]
    )
