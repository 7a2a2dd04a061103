"""The flag `--config FILE` of commands: read before the other flags, which override it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from coral.campaign.bench import changes
from coral.config import read_config, to_mapping

C = TypeVar("C")


def configured(words: Sequence[str], default: C) -> C | None:
    """Return the configuration in the file of `--config FILE` or `--config=FILE`; None without that flag.

    Raises:
        InputError: The file cannot be read, or is invalid.
    """
    for word, following in itertools.pairwise([*words, ""]):
        flag, joined, value = word.partition("=")
        file = value if joined else following
        if flag == "--config" and file:
            return read_config(Path(file), default)
    return None


def config_words(cfg: C, default: C, file: Path | None, prefix: str = "cfg") -> list[str]:
    """Return the command-line words that reproduce a configuration: the file, and flags for all differences from it."""
    base = default if file is None else read_config(file, default)
    named = ["--config", str(file)] if file is not None else []
    return named + [
        word
        for key, value in changes(to_mapping(cfg), to_mapping(base), prefix)
        for word in _words(key.replace("_", "-"), value)
    ]


def _words(key: str, value: Any) -> list[str]:
    """Format a flag for the command line."""
    if isinstance(value, bool):
        group, _, last = key.rpartition(".")
        return [f"--{group}.{'' if value else 'no-'}{last}"]
    return [f"--{key}", *map(str, value if isinstance(value, list | tuple) else [value])]
