"""Forty generated reefs, harder than the ten shipped ones, made when they are asked for: `gen:0` to `gen:39`."""

from __future__ import annotations

import re
from functools import lru_cache

from coral.errors import InputError
from coral.reef.generator.generate import GeneratorCfg, generate
from coral.reef.generator.pool import PREFIX as POOL
from coral.reef.generator.pool import pool_by_name
from coral.reef.generator.spines import Topology
from coral.reef.generator.word_missions import FAMILIES, word_mission
from coral.reef.generator.word_missions import PREFIX as WORDS
from coral.reef.world.kinds import find_kind
from coral.reef.world.world import ReefWorld

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


def make_world(name: str) -> ReefWorld:
    """Make the world of a name that begins with one of `MADE`.

    Raises:
        InputError: There is none of this name.
    """
    if name.startswith(KIND):
        return one_thing(name.removeprefix(KIND))
    if name.startswith(WORDS):
        return word_mission(name)
    return pool_by_name(name) if name.startswith(POOL) else generated(name)


def expand_name(name: str) -> tuple[str, ...]:
    """Return the worlds that a name stands for: `generated`, `gen:0-9`, `words:FAMILY:0-9`, `words:all:0`, or itself.

    Raises:
        InputError: A range of generated reefs that does not exist.
    """
    if words := re.fullmatch(rf"{WORDS}([a-z]+):(\d{{1,4}})(?:-(\d{{1,4}}))?", name, re.ASCII):
        families = FAMILIES if words[1] == "all" else (words[1],)
        first, last = int(words[2]), int(words[3] or words[2])
        if last < first:
            raise InputError("world", "", repr(name), f"{WORDS}{words[1]}:{last}-{first}")
        return tuple(f"{WORDS}{one}:{k}" for k in range(first, last + 1) for one in families)
    if name == "generated":
        return tuple(GENERATED)
    span = re.fullmatch(rf"{PREFIX}(\d+)-(\d+)", name, re.ASCII)
    if span is None:
        return (name,)
    first, last = int(span[1]), int(span[2])
    if not first <= last < COUNT:
        raise InputError("world", "", repr(name), f"a range within {PREFIX}0-{COUNT - 1}")
    return tuple(f"{PREFIX}{number}" for number in range(first, last + 1))
