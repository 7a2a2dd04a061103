"""`coral config`: the keys of a configuration, one of them explained, or what departs from the papers.

`Departs from the paper:` begins a sentence in the text of a key or of a group of keys, or in the docstring of the
module, class, function or constant that departs. There is no other list.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.commands.unread_settings import refused_by
from coral.errors import InputError, nearest
from coral.flags import Argument, Flag
from coral.foreign_file import read_text
from coral.help_page import first_sentence
from coral.surface import CONFIGURATIONS, described

WIDTH = 120
UNITS = {
    "m": "m", "mm": "mm", "m2": "m²", "s": "s", "ms": "ms", "1_s": "1/s", "m_s": "m/s", "m_s2": "m/s²",
    "deg": "deg", "deg_s": "deg/s", "rad": "rad", "rad_s": "rad/s", "hz": "Hz",
    "kg": "kg", "kg_m2": "kg m²", "n": "N", "n_m": "N m", "usd": "USD",
}  # fmt: skip
"""Unit by the end of a key; the n_m of a stiffness are N/m."""
_PARTS = {part for end in UNITS for part in end.split("_")}
HELP = f"{'; '.join(f'{name}, {what}' for name, (_, _, what) in CONFIGURATIONS.items())}."
DEPARTS = "Departs from the paper:"
PACKAGE = Path(__file__).parents[1]
PARTS = {"reef": "reef", "contact": "contact"}
"""Folder of the package whose code is read, by configuration; the others have none."""


@dataclass(frozen=True, kw_only=True)
class ListConfig:
    """List the keys of a configuration with their defaults, or explain one key or group of keys."""

    of: Annotated[str, Argument(metavar="CONFIGURATION", names=CONFIGURATIONS, help=HELP)]
    key: Annotated[str, Argument(metavar="[KEY]")] = ""
    """A key, such as pilot.trigger.stuck_s, or a group of keys, such as pilot.trigger."""
    departures: bool = False
    """What departs from the paper, with the reason: keys by their default, groups of keys, and code without a key."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        if self.of not in CONFIGURATIONS:
            known = f"one of {', '.join(CONFIGURATIONS)}{nearest(self.of, CONFIGURATIONS)}"
            raise InputError("coral config", "", repr(self.of), known)
        place, flag, _ = CONFIGURATIONS[self.of]
        about = described(place)
        asked = re.sub(rf"^({flag}|{flag[2:]})\.", "", self.key).replace("-", "_").strip(".")
        chosen = [each for each in about.flags if f"{'.'.join(each.field)}.".startswith(f"{asked}." if asked else "")]
        chosen = [each for each in chosen if not self.departures or departs(each.text)]
        more = rows_without_key(self.of, place, asked) if self.departures else []
        if not chosen and not more:
            keys = [".".join(each.field[:n]) for each in about.flags for n in range(1, len(each.field) + 1)]
            raise InputError(f"coral config {self.of}", "", repr(self.key), f"one of its keys{_near(asked, keys)}")
        groups = {group.prefix.removeprefix("--").replace("-", "_"): group.text for group in about.groups}
        return {
            "configuration": self.of,
            "key": asked,
            "text": groups.get(asked, about.text) if len(chosen) > 1 else about.text,
            "keys": [*(_row(self.of, each, flag) for each in chosen), *more],
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        rows = result["keys"]
        if self.departures:
            shown = (f" = {_amount(row)}" if row["flag"] else "" for row in rows)
            return "\n".join(
                textwrap.fill(f"{row['key']}{amount}: {row['text']}", WIDTH, subsequent_indent="  ")
                for row, amount in zip(rows, shown, strict=True)
            )
        if len(rows) == 1 and rows[0]["key"] == result["key"]:
            return _explained(rows[0])
        keys = max(len(row["key"]) for row in rows) + 2
        lines = [f"{row['key']:<{keys}}{_amount(row):<14} {first_sentence(row['text'])}".rstrip() for row in rows]
        lines = [line if len(line) <= WIDTH else f"{line[: WIDTH - 1].rstrip()}…" for line in lines]
        flag = CONFIGURATIONS[result["configuration"]][1]
        ends = f"Set one by {flag}.KEY VALUE; explain one by: coral config {result['configuration']} KEY"
        return "\n".join([textwrap.fill(result["text"], WIDTH), "", *lines, "", ends])


def _near(asked: str, keys: list[str]) -> str:
    """Suggest the nearest key; its last part alone is looked for too."""
    whole = {key.rpartition(".")[2]: key for key in keys} | {key: key for key in keys}
    return re.sub(r"'(.+)'", lambda match: repr(whole[match[1]]), nearest(asked, whole))


def _row(of: str, flag: Flag, prefix: str) -> dict[str, Any]:
    key = ".".join(flag.field)
    return {
        "key": key,
        "default": flag.default,
        "unit": _unit(flag.field[-1]) if "number" in flag.type else "",
        "accepted": flag.type,
        "text": flag.text,
        "refused_by": [f"coral {command}" for command in refused_by(key) if command.startswith(f"{of} ")],
        "flag": f"{prefix}.{flag.name.removeprefix('--')}",
    }


def _unit(name: str) -> str:
    """Return the unit that the end of a key names, or ""."""
    parts = name.split("_")
    while parts and not all(part in _PARTS for part in parts):
        parts.pop(0)
    unit = UNITS.get("_".join(parts), "")
    return "N/m" if unit == "N m" and "stiffness" in name else unit


def _amount(row: Mapping[str, Any]) -> str:
    """Format the default with its unit."""
    return f"{row['default'] or '-'} {row['unit']}".strip()


def _explained(row: Mapping[str, Any]) -> str:
    lines = [f"{row['key']} = {_amount(row)}"]
    if row["text"]:
        lines.append(textwrap.fill(row["text"], WIDTH, initial_indent="  ", subsequent_indent="  "))
    lines.append(f"  accepted: {row['accepted']}")
    if row["refused_by"]:
        lines.append(f"  not read, and refused, by: {', '.join(row['refused_by'])}")
    return "\n".join([*lines, f"  set by: {row['flag']} {'' if row['accepted'] == 'yes or no' else 'VALUE'}".rstrip()])


def departs(text: str) -> bool:
    """Return whether a text says how something departs from the paper."""
    return DEPARTS in " ".join(text.split())


def departing_groups(place: str, asked: str) -> dict[str, str]:
    """Return the groups of keys of a configuration whose text departs, below a key or group, or all for ""."""
    about = described(place)
    keys = {group.prefix.removeprefix("--").replace("-", "_"): group.text for group in about.groups}
    return {key: text for key, text in keys.items() if departs(text) and f"{key}.".startswith(asked and f"{asked}.")}


def departing_code(of: str) -> dict[str, list[str]]:
    """Return the paragraphs in docstrings of the code that depart, by file; those of keys and groups are left out."""
    folder = PACKAGE / PARTS[of] if of in PARTS else None
    found: dict[str, list[str]] = {}
    for file in sorted(folder.rglob("*.py")) if folder else ():
        text = read_text(file, "a module of this package")
        if departs(text):
            said = [one for doc in _docstrings(ast.parse(text)) for one in _paragraphs(doc)]
            found |= {f"{file.relative_to(PACKAGE.parent)}": said} if said else {}
    return found


def _docstrings(tree: ast.Module) -> Iterator[str]:
    """Yield the docstrings of module, classes and functions, and the texts below the module's constants."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            yield ast.get_docstring(node) or ""
    for before, node in zip(tree.body, tree.body[1:], strict=False):
        if isinstance(before, ast.Assign | ast.AnnAssign) and isinstance(node, ast.Expr):
            value = node.value
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield inspect.cleandoc(value.value)


def _paragraphs(doc: str) -> Iterator[str]:
    """Yield of each paragraph what departs, from those words on."""
    for paragraph in re.split(r"\n\s*\n", doc):
        _, words, said = " ".join(paragraph.split()).partition(DEPARTS)
        if words:
            yield f"{words}{said}"


def rows_without_key(of: str, place: str, asked: str) -> list[dict[str, Any]]:
    """Return rows, like those of keys, of groups and of code that departs; of code only if no key is asked for."""
    said = list(departing_groups(place, asked).items())
    said += [] if asked else [(file, one) for file, texts in departing_code(of).items() for one in texts]
    empty = dict.fromkeys(("default", "unit", "accepted", "flag"), "")
    return [{"key": key, **empty, "text": text, "refused_by": []} for key, text in said]
