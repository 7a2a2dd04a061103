"""Worlds by name: shipped ones, files, and those that a wing makes when they are asked for."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from coral.plugins import our_part
from coral.reef.world.world import ReefWorld, load_world, shipped_worlds

MADE = re.compile(r"(?:kind|words|pool):.*|gen:\S*", re.DOTALL)
"""Names of worlds that are made: one thing on sand, missions in words, pools, generated reefs."""


def find_world(name: str | Path) -> ReefWorld:
    """Return a shipped reef, one that is made, or that of a world file.

    Raises:
        InputError: There is no such world, or the file is broken.
    """
    text = str(name)
    if not MADE.fullmatch(text) or Path(text).exists():
        return load_world(text)
    world: ReefWorld = our_part("generator", "world", "world")(text)
    return world


def expand_names(names: Iterable[str]) -> tuple[str, ...]:
    """Replace the names of sets of reefs by those of the reefs.

    Sets: `all`, the ten shipped ones; `generated`; `gen:0-9`; missions, `words:FAMILY:0-9`, `words:all:0`.

    Raises:
        InputError: A range of generated reefs that does not exist.
    """
    found: list[str] = []
    for name in names:
        if name == "all":
            found += shipped_worlds()
        elif name == "generated" or MADE.fullmatch(name):
            found += our_part("generator", "names", "world")(name)
        else:
            found.append(name)
    return tuple(dict.fromkeys(found))
