"""Forty generated reefs, harder than the ten shipped ones, made when they are asked for: `gen:0` to `gen:39`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from coral.errors import InputError
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.kinds import find_kind
from coral.reef.world.pool import PREFIX as POOL
from coral.reef.world.pool import pool_by_name
from coral.reef.world.spines import Topology
from coral.reef.world.word_missions import FAMILIES, word_mission
from coral.reef.world.word_missions import PREFIX as WORDS
from coral.reef.world.world import ReefWorld, load_world, shipped_worlds

PREFIX, KIND = "gen:", "kind:"
COUNT = 40
_KINDS: tuple[Topology, ...] = ("branching", "looping", "patchy")
"""In turn, eight at a time: three of eight branch, three loop, two are broken into patches."""
_EDGES_M = (30.0, 36.0, 42.0, 48.0, 54.0, 60.0, 33.0, 40.0, 51.0, 45.0)
"""In turn. The shipped reefs have 20 to 30 m."""


def _settings(number: int) -> GeneratorCfg:
    kind, edge = _KINDS[number % 8 % 3], _EDGES_M[number % len(_EDGES_M)]
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


def one_thing(kind: str) -> ReefWorld:
    """Return bare sand with one thing of a kind in its middle, at (10, 10) m, to look at.

    Raises:
        InputError: There is no such kind.
    """
    find_kind(kind)
    far = {"name": "corner", "oysters": [{"x": 19.0, "y": 19.0, "z": 0.0, "radii": [0.05, 0.04, 0.03]}]}
    return ReefWorld.model_validate(
        {
            "name": f"kind-{kind}",
            "size_m": [20.0, 20.0],
            "start": {"x": 6.0, "y": 10.0},
            "clusters": [far],
            "things": [{"name": kind, "kind": kind, "x": 10.0, "y": 10.0, "yaw": 0.4}],
        }
    )


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
    if text.startswith(KIND) and not Path(text).exists():
        return one_thing(text.removeprefix(KIND))
    if text.startswith(WORDS) and not Path(text).exists():
        return word_mission(text)
    if text.startswith(POOL) and not Path(text).exists():
        return pool_by_name(text)
    return generated(text) if re.fullmatch(rf"{PREFIX}\S*", text) and not Path(text).exists() else load_world(text)


def expand_names(names: Iterable[str]) -> tuple[str, ...]:
    """Replace the names of sets of reefs by those of the reefs.

    Sets: `all`, the ten shipped ones; `generated`; `gen:0-9`; missions, `words:FAMILY:0-9`, `words:all:0`.

    Raises:
        InputError: A range of generated reefs that does not exist.
    """
    found: list[str] = []
    for name in names:
        if words := re.fullmatch(rf"{WORDS}([a-z]+):(\d{{1,4}})(?:-(\d{{1,4}}))?", name, re.ASCII):
            families = FAMILIES if words[1] == "all" else (words[1],)
            first, last = int(words[2]), int(words[3] or words[2])
            if last < first:
                raise InputError("world", "", repr(name), f"{WORDS}{words[1]}:{last}-{first}")
            found += (f"{WORDS}{one}:{k}" for k in range(first, last + 1) for one in families)
            continue
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
