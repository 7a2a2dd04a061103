"""The dimension of a reef campaign that is water and sensors: a setting's key `preset`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from coral.campaign.columns import Row
from coral.campaign.sweep import setting_text
from coral.foreign_file import parse_json

KEY = "preset"
"""Of a spec's overrides; without it the water is clear."""
CLEAR = "clear"


def with_presets(names: Iterable[str], settings: Iterable[Mapping[str, Any]]) -> tuple[dict[str, Any], ...]:
    """Return every setting in the water of every preset; clear water needs no key."""
    settings = tuple(settings)
    return tuple(({} if name == CLEAR else {KEY: name}) | dict(setting) for name in names for setting in settings)


def by_preset(rows: Iterable[Row]) -> dict[str, list[dict[str, Any]]]:
    """Group rows by preset, each without that key in its overrides and its setting."""
    found: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        changes = parse_json(row["overrides"])
        preset = str(changes.pop(KEY, CLEAR))
        plain = {**row, "overrides": json.dumps(changes, sort_keys=True), "setting": setting_text(changes)}
        found.setdefault(preset, []).append(plain)
    return found
