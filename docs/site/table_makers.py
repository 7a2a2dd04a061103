"""Makers of tables of the reference, which read the code."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass
from itertools import groupby, pairwise
from typing import Any, get_args

from coral import limits
from coral.advisor.setting import Mistake
from coral.cli import COMMANDS
from coral.commands.config import ListConfig
from coral.commands.keyboard import KEYS
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.task_names import HALVES, suite_tasks
from coral.flags import class_doc, field_docs
from coral.reef.eyes import reef_net
from coral.reef.mission.presets import NOISE, PRESETS
from coral.reef.networks import semantic_map, yolo_eyes
from coral.reef.sea.operator import WORDS
from coral.reef.vehicle.states import CHANGES
from coral.reef.world.kinds import catalogue
from coral.reef.world.water_types import water_of_visibility
from coral.surface import described
from coral.view.live.controls import BUTTONS

Rows = Iterable[Iterable[object]]


def table(head: str, rows: Rows) -> str:
    """Return a table in Markdown; the head names its columns."""
    titles = [title.strip() for title in head.split("|")]
    lines = [" | ".join(" ".join(str(cell).split()).replace("|", "\\|") for cell in row) for row in rows]
    return "\n".join([f"| {' | '.join(titles)} |", "|" + "---|" * len(titles), *(f"| {line} |" for line in lines)])


def commands() -> str:
    """Return every command with its flags."""
    parts = []
    for name, (place, _) in COMMANDS.items():
        command = described(place)
        words = " ".join(flag.name for flag in command.flags if flag.positional)
        rows = [
            (f"`{flag.name}`", f"`{flag.default}`" if flag.default else "", flag.text)
            for flag in command.flags
            if "." not in flag.name
        ]
        text = " ".join(command.text.split())
        parts.append(f"## coral {name}\n\n`coral {name} {words}`. {text}\n\n{table('flag | default | what', rows)}")
    return "\n\n".join(parts)


def flag_texts(name: str) -> str:
    """Return what a flag does in each command that has it."""
    found = ((command, flag) for command, (place, _) in COMMANDS.items() for flag in described(place).flags)
    return table("command | what", ((f"`coral {command}`", flag.text) for command, flag in found if flag.name == name))


def settings(of: str, key: str = "") -> str:
    """Return the keys of a configuration, or those that begin with `key`, in groups."""
    parts = []
    for group, rows in groupby(ListConfig(of=of, key=key)()["keys"], lambda row: row["key"].rpartition(".")[0]):
        cells = (
            (f"`{row['key'].rpartition('.')[2]}`", f"{row['default'] or '–'} {row['unit']}", row["text"])
            for row in rows
        )
        parts.append(f"**{group or of}**\n\n" + table("key | default | what", cells))
    return "\n\n".join(parts)


def departures(of: str) -> str:
    """Return the keys whose default departs from the paper, and what departs without a key."""
    rows = ListConfig(of=of, departures=True)()["keys"]
    return table(
        "key | default | what", ((f"`{row['key']}`", f"{row['default']} {row['unit']}", row["text"]) for row in rows)
    )


def named(head: str, rows: Mapping[str, str]) -> str:
    """Return a table of names and texts."""
    return table(head, ((f"`{name}`", text) for name, text in rows.items()))


def files(kind: type, head: str = "file | what") -> str:
    """Return the values of a class's fields with the text below each."""

    def name_of(value: object) -> str:
        return "`, `".join(map(str, value if isinstance(value, tuple) else (value,)))

    return named(head, {name_of(getattr(kind, name)): text for name, text in field_docs(kind).items()})


def first_paragraphs(head: str, parts: Mapping[str, object]) -> str:
    """Return the first paragraph of each part's docstring."""
    return named(head, {name: (inspect.getdoc(part) or "").partition("\n\n")[0] for name, part in parts.items()})


def waters() -> str:
    """Return the water of the pictures under each preset."""

    def metres(value: float | None) -> str:
        return "no limit" if value is None else f"{value:.2g} m"

    seen = {name: preset.values.get(f"{NOISE}visibility_m") for name, preset in PRESETS.items()}
    rows = ((name, limit, water_of_visibility(limit)) for name, limit in seen.items())
    return table(
        "preset | its visibility | water | the water's visibility",
        ((f"`{name}`", metres(limit), f"`{water.name}`", metres(water.visibility_m)) for name, limit, water in rows),
    )


def layouts() -> str:
    """Return what networks may look like."""
    picture, ours = "3 channels", "4 channels: RGB from -1 to 1, inverse depth of the flat sea floor (1/m)"
    rows = [
        (semantic_map.OUTPUTS, picture, "a semantic network"),
        *(
            (f"{shape}, and 32 mask prototypes", picture, f"YOLO, {yolo_eyes.LAYOUTS[layout]}")
            for layout, shape in yolo_eyes.OUTPUTS.items()
        ),
        (", ".join(reef_net.OUTPUTS), ours, "a network from `coral reef eyes train`"),
    ]
    return table("outputs | input | what", ((f"`{outputs}`", *rest) for outputs, *rest in rows))


def topics(found: Mapping[str, tuple[str, str]]) -> str:
    """Return topics with their types."""
    rows = ((f"`{name}`", kind.split("/")[-1], what) for name, (kind, what) in found.items())
    return table("topic | type | what", rows)


def suite(suite: str) -> str:
    """Return the tasks of a suite."""
    rows = ((f"`{name}`", half, load_task_file(name).title) for half in HALVES for name in suite_tasks(suite, half))
    return table("task | half | what", rows)


def kinds() -> str:
    """Return the kinds of things on the sea floor."""
    rows = ((f"`{name}`", kind.class_, kind.says) for name, kind in catalogue().kinds.items())
    return table("kind | class | what", rows)


def size_limits() -> str:
    """Return the limits on foreign files."""
    body = ast.parse(inspect.getsource(limits)).body
    return table(
        "limit | value | of what, and why",
        (
            (f"`{one.targets[0].id}`", f"{getattr(limits, one.targets[0].id):,.0f}", below.value.value)
            for one, below in pairwise(body)
            if isinstance(one, ast.Assign)
            and isinstance(one.targets[0], ast.Name)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
        ),
    )


def states() -> str:
    """Return the changes of a vehicle's state."""
    return table(
        "from | to | who | cause | when",
        (
            (row.source, row.target, row.who, row.cause, row.means + (" *Only its own hold.*" if row.after else ""))
            for row in CHANGES
        ),
    )


def operator() -> str:
    """Return what the operator of a vehicle may say, by keyboard and page."""
    labels = {word: label for word, label, *_ in BUTTONS}

    def keys_of(said: str) -> str:
        return ", ".join(f"`{key.strip() or 'space'}`" for key, word in KEYS.items() if word == said)

    rows = ((f"`{word}`", keys_of(word) or "–", labels.get(word, "–"), text) for word, text in WORDS.items())
    return table("word | key | button of the page | what", rows)


def mistakes(found: Iterable[Mistake]) -> str:
    """Return the plausible errors of an advisor."""

    def linked(text: str) -> str:
        return re.sub(r"arXiv:([\d.]+\d)", r"[arXiv:\1](https://arxiv.org/abs/\1)", text)

    rows = ((f"`{one.name}`", one.what, linked(one.found_in) or "–") for one in found)
    return table("error | what goes wrong | where models were found to make it", rows)


def presets() -> str:
    """Return the values of the presets."""
    return table(
        "preset | key | value | why",
        (
            (f"`{name}`", f"`{condition.key}`", f"{condition.value:g}", condition.reason)
            for name, preset in PRESETS.items()
            for condition in preset.conditions
        ),
    )


def _plain(default: object) -> str:
    """Return a default as it would stand in a file; nothing where it says nothing."""
    values = default if isinstance(default, tuple) else (default,)
    plain = default not in ((), "") and all(isinstance(value, str | int | float) for value in values)
    return f"`{list(values) if isinstance(default, tuple) else default}`" if plain else ""


def conditions(union: object) -> str:
    """Return the kinds of a condition with their keys."""

    def keys_of(kind: type) -> str:
        fields = {key: field for key, field in kind.model_fields.items() if key not in ("kind", "object")}  # type: ignore[attr-defined]
        return ", ".join(
            f"`{key}`" + ("" if field.is_required() or not _plain(field.default) else f" ({field.default})")
            for key, field in fields.items()
        )

    ordered = sorted(get_args(get_args(union)[0]), key=lambda kind: kind.model_fields["kind"].default)
    return table(
        "kind | holds when | keys (default)",
        ((f"`{kind.model_fields['kind'].default}`", class_doc(kind), keys_of(kind)) for kind in ordered),
    )


def keys(place: str, kind: Any, *, nested: bool = True) -> str:
    """Return the keys of a file, then those of its parts. Keys without a text share that of the next one."""
    parts, seen, tables = [(place, kind)], [kind], []
    for place, kind in parts:  # grows
        listed = inspect.getdoc(kind).partition("Args:")[2]
        docs = dict(re.findall(r"^    (\w+): (.*?)(?=^    \w+: |\Z)", listed, re.M | re.S)) | field_docs(kind)
        rows: list[tuple[str, str, str]] = []
        names, defaults = [], []
        for name, field in (kind.__dataclass_fields__ if is_dataclass(kind) else kind.model_fields).items():
            needed = field.default is field.default_factory if is_dataclass(kind) else field.is_required()
            names.append(f"`{name}`")
            defaults.append("required" if needed else _plain(field.default))
            if name in docs:
                rows.append((", ".join(names), ", ".join(dict.fromkeys(filter(None, defaults))), docs[name]))
                names, defaults = [], []
            if nested and name != "conditions":  # they have a table of their own
                found = [one for one in _models(getattr(field, "annotation", None)) if one not in seen]
                parts += [(name, one) for one in found]
                seen += found
        rows += [(name, "", "") for name in names]
        tables.append(f"**`{place}`**: {class_doc(kind)}\n\n{table('key | default | what', rows)}")
    return "\n\n".join(tables)


def _models(annotation: Any) -> Iterator[type]:
    """Find the models in an annotation."""
    if hasattr(annotation, "model_fields"):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)
