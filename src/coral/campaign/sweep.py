"""Settings of a campaign's episodes beside their variant: swept keys, one at a time, and presets of the water."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from coral.campaign.spec import parse_names
from coral.errors import InputError
from coral.foreign_file import parse_json

PRESET, CLEAR = "preset", "clear"
"""Key of a preset among a spec's overrides; without it the water is clear."""
NOMINAL = "nominal"
"""Setting of an episode without changes."""


def parse_sweeps(texts: Iterable[str]) -> tuple[dict[str, Any], ...]:
    """Parse `KEY=V1,V2` to one mapping for each distinct value, after an empty one for the nominal setting.

    Raises:
        InputError: There is no key or no value.
    """
    settings: list[dict[str, Any]] = [{}]
    for text in texts:
        key, _, rest = (part.strip() for part in text.partition("="))
        if not key or not rest:
            raise InputError("--sweep", "", repr(text), "KEY=V1,V2,..., such as current=0.1,0.2")
        settings += ({key: _value(word)} for word in parse_names(rest, "--sweep"))
    return tuple(dict(pairs) for pairs in dict.fromkeys(tuple(setting.items()) for setting in settings))


def setting_text(overrides: Mapping[str, Any] | str) -> str:
    """Describe overrides of a spec, or the data set's column of them: `current=0.2`, or `nominal`."""
    changes: Mapping[str, Any] = parse_json(overrides) if isinstance(overrides, str) else overrides
    return ", ".join(f"{key}={value}" for key, value in changes.items()) or NOMINAL


def in_order(overrides: Iterable[str]) -> list[str]:
    """Order distinct columns of overrides: the nominal setting, then key by key in their order, numbers ascending.

    An extended campaign has its values in the order of the requests.
    """
    settings = list(dict.fromkeys(overrides))
    keys = list(dict.fromkeys(tuple(parse_json(text)) for text in settings))

    def place(text: str) -> tuple[bool, int, bool, float]:
        changes = parse_json(text)
        value = next(iter(changes.values()), None)
        size = float(value) if isinstance(value, int | float) else None
        return bool(changes), keys.index(tuple(changes)), size is None, size or 0.0

    return sorted(settings, key=place)


def with_presets(names: Iterable[str], settings: Iterable[Mapping[str, Any]]) -> tuple[dict[str, Any], ...]:
    """Return every setting in the water of every preset; clear water needs no key."""
    settings = tuple(settings)
    return tuple(({} if name == CLEAR else {PRESET: name}) | dict(setting) for name in names for setting in settings)


def by_preset(rows: Iterable[Mapping[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """Group rows by preset, each without that key in its overrides and its setting."""
    found: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        changes = parse_json(row["overrides"])
        preset = str(changes.pop(PRESET, CLEAR))
        plain = {**row, "overrides": json.dumps(changes, sort_keys=True), "setting": setting_text(changes)}
        found.setdefault(preset, []).append(plain)
    return found


def _value(word: str) -> Any:
    """Parse JSON, else return the text. Infinities stay text, so that numeric fields reject them."""
    try:
        return parse_json(word, constant=str)
    except ValueError:
        return word
