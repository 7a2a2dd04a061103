"""Configurations given in Python: the dataclass itself, some of its keys, or a YAML file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from coral.config import changed_keys, dotted_keys, merge, nested, read_yaml
from coral.errors import InputError

C = TypeVar("C")


def resolve_settings(given: Any, default: C, where: str = "cfg") -> tuple[C, frozenset[str]]:
    """Return a configuration, and the dotted keys that were set.

    Given is a configuration, a mapping of keys (nested, or dotted as on the command line), a YAML file, or None.

    Raises:
        InputError: A key is unknown, a value is wrong, or the file cannot be read.
    """
    if given is None:
        return default, frozenset()
    if isinstance(given, str | Path):
        content: Mapping[str, Any] = read_yaml(Path(given))
        return merge(default, content, str(given)), frozenset(dotted_keys(content))
    if isinstance(given, Mapping):
        content = nested(given, where)
        return merge(default, content, where), frozenset(dotted_keys(content))
    if not dataclasses.is_dataclass(given) or not isinstance(given, type(default)):
        expected = f"a {type(default).__name__}, a mapping of its keys or a YAML file"
        raise InputError(where, "", f"{type(given).__name__}", expected)
    return given, frozenset(changed_keys(given, default))
