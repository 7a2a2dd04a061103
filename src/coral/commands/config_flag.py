"""The flag `--config FILE` of commands: read before the other flags, which override it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from coral.config import changed_keys, dotted_keys, read_config, read_yaml

C = TypeVar("C")


def configured(words: Sequence[str], default: C) -> C | None:
    """Return the configuration in the file of `--config FILE` or `--config=FILE`; None without that flag.

    Raises:
        InputError: The file cannot be read, or is invalid.
    """
    file = flag_value(words, "--config")
    return read_config(Path(file), default) if file else None


def flag_value(words: Sequence[str], name: str) -> str:
    """Return the value of a flag, as in `--config FILE` or `--config=FILE`; "" without it."""
    for word, following in itertools.pairwise([*words, ""]):
        flag, joined, value = word.partition("=")
        if flag == name and (found := value if joined else following):
            return found
    return ""


def given_keys(words: Sequence[str], prefix: str = "cfg") -> tuple[str, ...]:
    """Return the dotted keys of a configuration that flags or the file of `--config` set, be it to the default.

    Raises:
        InputError: The file cannot be read.
    """
    start = f"--{prefix}."
    flags = []
    for word in words:
        if word.startswith(start):
            group, _, last = word[len(start) :].partition("=")[0].replace("-", "_").rpartition(".")
            flags.append(f"{group}.{last.removeprefix('no_')}".removeprefix("."))
    file = flag_value(words, "--config")
    return tuple(dict.fromkeys([*flags, *(dotted_keys(read_yaml(Path(file))) if file else ())]))


def set_keys(cfg: C, default: C, given: Sequence[str] = ()) -> frozenset[str]:
    """Return the dotted keys that a user has set: those given by name, and those that differ from the default."""
    return frozenset([*given, *changed_keys(cfg, default)])
