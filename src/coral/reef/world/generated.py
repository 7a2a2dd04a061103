"""Forty generated reefs, harder than the ten shipped ones, made when they are asked for: `gen:0` to `gen:39`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from coral.errors import InputError
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.pool import PREFIX as POOL
from coral.reef.world.pool import pool_by_name
from coral.reef.world.spines import Topology
from coral.reef.world.world import ReefWorld, load_world, shipped_worlds

PREFIX = "gen:"
COUNT = 40
_KINDS: tuple[Topology, ...] = (
    "branching",
    "looping",
    "patchy",
    "branching",
    "looping",
    "patchy",
    "branching",
    "looping",
)
"""In turn: three of eight branch, three loop, two are broken into patches."""
_EDGES_M = (30.0, 36.0, 42.0, 48.0, 54.0, 60.0, 33.0, 40.0, 51.0, 45.0)
"""In turn. The shipped reefs have 20 to 30 m."""


def _settings(number: int) -> GeneratorCfg:
    kind, edge = _KINDS[number % len(_KINDS)], _EDGES_M[number % len(_EDGES_M)]
    return GeneratorCfg(
        topology=kind,
        size_m=(edge, edge),
        clusters=0,
        dense_obstacles=16,
        obstacles=round(1.4 * edge),
        barriers=2 + round(edge / 20.0),
        passage_m=0.8,
        seed=1000 + number,
    )


GENERATED: dict[str, GeneratorCfg] = {f"{PREFIX}{number}": _settings(number) for number in range(COUNT)}
"""Settings by name. They never change, so that results stay comparable: new reefs would get new numbers."""


@lru_cache(maxsize=COUNT)
def generated(name: str) -> ReefWorld:
    """Make one of the forty reefs; it is the same every time.

    Raises:
        InputError: There is none of this name.
    """
    if name not in GENERATED:
        raise InputError("world", "", repr(name), f"{PREFIX}0 to {PREFIX}{COUNT - 1}")
    return generate(GENERATED[name], name.replace(":", "-"))


def find_world(name: str | Path) -> ReefWorld:
    """Return a shipped reef, a generated one, a pool, or that of a world file.

    Raises:
        InputError: There is no such world, or the file is broken.
    """
    text = str(name)
    if text.startswith(POOL) and not Path(text).exists():
        return pool_by_name(text)
    return generated(text) if re.fullmatch(rf"{PREFIX}\S*", text) and not Path(text).exists() else load_world(text)


def expand_names(names: Iterable[str]) -> tuple[str, ...]:
    """Replace the names of sets of reefs by those of the reefs: `all`, the ten shipped ones; `generated`; `gen:0-9`.

    Raises:
        InputError: A range of generated reefs that does not exist.
    """
    found: list[str] = []
    for name in names:
        span = re.fullmatch(rf"{PREFIX}(\d+)-(\d+)", name, re.ASCII)
        if name == "all":
            found += shipped_worlds()
        elif name == "generated":
            found += GENERATED
        elif span is not None:
            first, last = int(span[1]), int(span[2])
            if not first <= last < COUNT:
                raise InputError("world", "", repr(name), f"a range within {PREFIX}0-{COUNT - 1}")
            found += (f"{PREFIX}{number}" for number in range(first, last + 1))
        else:
            found.append(name)
    return tuple(dict.fromkeys(found))
