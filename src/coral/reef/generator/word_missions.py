"""Missions in words by name, made when they are asked for: `words:FAMILY:N`, eight families, two halves of each.

What lies where is drawn from the number. Numbers below 100 are for development, the others for tests, with instructions
in other words. Shape, size and order of things tell nothing about their kinds.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache, partial
from pathlib import Path
from zlib import crc32

import numpy as np

from coral.errors import InputError, nearest
from coral.foreign_file import read_text
from coral.reef.world.instruction import (
    Answered,
    Clause,
    DoneBy,
    EndsAt,
    InOrder,
    Inspected,
    KeptOff,
    MissionText,
    Sides,
    Spared,
)
from coral.reef.world.world_check import check_world
from coral.reef.world.world_model import ReefWorld
from coral.yaml_file import load_mapping

PREFIX = "words:"
TEXTS = Path(__file__).parent / "word_missions.yaml"
TEST_FROM = 100
"""Numbers from here on are of the test half."""
SIZE_M = (26.0, 20.0)
START = (2.5, 10.0)
TIME_S = 600.0
"""In water of 4.5 m of visibility, the whole area takes 250 s, and each of seven things 15 to 25 s with its answer."""
APART_M, FROM_START_M, EDGE_M = 4.6, 4.5, 2.5
"""Least distance between things, from the start, and from the edge."""
AHEAD_M, AHEAD_HALF_M = 9.0, 2.0
"""Water ahead of the start that stays empty: length, and half of the width."""
POSTS, FROM_POST_M = 3, 2.4
ANIMALS, ROOM_M = ("fish", "crab", "ray"), 2.6
"""What swims or walks past, one of each, so far from the edges or at a thing that a mission names."""
LIKE_OYSTERS = ("dead-shell", "mussels", "sponge", "shell-bags", "reef-ball", "crab-pot", "tyre")

Draft = tuple[list[tuple[str, str]], tuple[Clause, ...]]
"""Names and kinds of the things, and the conditions. An animal is named after the thing that it lives at."""


def _others(rng: np.random.Generator, count: int, without: Sequence[str]) -> list[tuple[str, str]]:
    """Draw things that a mission is not about."""
    kinds = [kind for kind in LIKE_OYSTERS if kind not in without]
    return [(f"other-{k + 1}", str(rng.choice(kinds))) for k in range(count)]


def _many(kind: str, count: int) -> list[tuple[str, str]]:
    return [(f"{kind}-{k + 1}", kind) for k in range(count)]


def _living(rng: np.random.Generator) -> Draft:
    dead = [(f"dead-{k + 1}", str(rng.choice(["dead-shell", "mussels"]))) for k in range(4)]
    wanted = ("living-clump",)
    return [*_many("living-clump", 3), *dead], (Inspected(of=wanted), Spared(besides=wanted, at_most=2))


def _net(rng: np.random.Generator) -> Draft:
    net = ("ghost-net",)
    return (
        [("net", "ghost-net"), *_others(rng, 5, ())],
        (Sides(of=net, count=3, within_m=6.0), KeptOff(of=net, distance_m=1.0), Spared(besides=net, at_most=3)),
    )


def _order(rng: np.random.Generator) -> Draft:
    wanted = ("crab-pot", "tyre", "sponge")
    return (
        [(kind, kind) for kind in wanted] + _others(rng, 3, wanted),
        (InOrder(of=wanted), Spared(besides=wanted, at_most=2)),
    )


def _count(rng: np.random.Generator) -> Draft:
    number = int(rng.integers(2, 5))
    things = [*_many("reef-ball", number), *_others(rng, 6 - number + int(rng.integers(0, 2)), ("reef-ball",))]
    seen = Inspected(of=("reef-ball",)), Spared(besides=("reef-ball",), at_most=3)
    return things, (*seen, Answered(right=(str(number),)), EndsAt(), DoneBy(time_s=TIME_S))


def _plots(rng: np.random.Generator, asked: str = "plot-old") -> Draft:
    kinds = ["plot-old", "plot-young", "plot-young"]
    order = rng.permutation(3)
    names = ("north", "east", "south")
    things = [(name, kinds[k]) for name, k in zip(names, order, strict=True)]
    things += [(f"{names[order.tolist().index(k)]}-{ANIMALS[k - 1]}", ANIMALS[k - 1]) for k in range(3)]
    right = next(name.partition("-")[0] for name, kind in things if kind == asked)
    wrong = tuple(name for name in names if name != right)
    return (
        [*things, *_others(rng, 3, ())],
        (Inspected(of=names), Answered(right=(right,), wrong=wrong), DoneBy(time_s=TIME_S)),
    )


def _east(rng: np.random.Generator) -> Draft:
    wanted = ("east-1", "east-2", "east-3")
    things = [(name, "living-clump") for name in wanted] + [(f"west-{k + 1}", "living-clump") for k in range(2)]
    return (
        [*things, *((f"east-dead-{k + 1}", "dead-shell") for k in range(2))],
        (Inspected(of=wanted, count=2), Spared(besides=wanted, at_most=2), EndsAt(), DoneBy(time_s=TIME_S)),
    )


def _bags(rng: np.random.Generator) -> Draft:
    wanted = ("shell-bags",)
    return (
        [*_many("shell-bags", 2), *_many("sponge", 2), *_others(rng, 2, ("sponge", "shell-bags"))],
        (Inspected(of=wanted), KeptOff(of=("sponge",), distance_m=1.0), EndsAt(), Spared(besides=wanted, at_most=2)),
    )


def _cable(rng: np.random.Generator) -> Draft:
    pieces = [(f"cable-{k + 1}", "cable") for k in range(4)]
    along = tuple(name for name, _ in pieces)
    return (
        [*pieces, ("damage", "cable-damage"), *_others(rng, 4, ())],
        (Inspected(of=along, share=0.75), EndsAt(at="damage", within_m=3.0), DoneBy(time_s=TIME_S)),
    )


FAMILIES: dict[str, tuple[Callable[[np.random.Generator], Draft], ...]] = {
    "living": (_living,),
    "net": (_net,),
    "order": (_order,),
    "count": (_count,),
    "plots": (_plots, partial(_plots, asked="fish")),
    "east": (_east,),
    "bags": (_bags,),
    "cable": (_cable,),
}
"""What is drawn, in turn by number, as the instructions are."""


@cache
def instructions() -> dict[str, dict[str, list[str]]]:
    """Return the instructions of each family: those for development and those for tests, in turn by number."""
    where = str(TEXTS)
    return load_mapping(read_text(TEXTS, where), where, expected="families")


def half_of(name: str) -> str:
    """Return the half that a mission is of, "development" or "test"; "" for a world without words."""
    if not name.startswith(PREFIX):
        return ""
    return "test" if int(name.rpartition(":")[2]) >= TEST_FROM else "development"


@lru_cache(maxsize=64)
def word_mission(name: str) -> ReefWorld:
    """Make a mission; it is the same every time.

    Raises:
        InputError: There is none of this name.
    """
    match = re.fullmatch(rf"{PREFIX}([a-z]+):(\d{{1,4}})", name, re.ASCII)
    if match is None or match[1] not in FAMILIES:
        given = name.removeprefix(PREFIX).partition(":")[0]
        raise InputError(
            "world",
            "",
            repr(name),
            f"{PREFIX}FAMILY:NUMBER, one of {', '.join(FAMILIES)}{nearest(given, list(FAMILIES))}",
        )
    drafts, number = FAMILIES[match[1]], int(match[2])
    rng = np.random.default_rng([crc32(match[1].encode()), number])
    things, conditions = drafts[number % len(drafts)](rng)
    said = instructions()[match[1]][half_of(name)]
    text = MissionText(instruction=said[number % len(said)], time_s=TIME_S, conditions=conditions)
    placed = _place([one for one in things if one[1] not in ANIMALS], rng)
    homes = {kind: name.partition("-")[0] for name, kind in things if kind in ANIMALS}
    posts = _posts(placed, rng)
    world = ReefWorld.model_validate(
        {
            "name": name.replace(":", "-"),
            "size_m": SIZE_M,
            "start": {"x": START[0], "y": START[1]},
            "seed": number,
            "clusters": [],
            "obstacles": posts,
            "things": [*placed, *_animals(number, match[1], placed, homes)],
            "mission": text.model_dump(mode="json"),
        }
    )
    check_world(world, name)
    return world


def _place(things: Sequence[tuple[str, str]], rng: np.random.Generator) -> list[dict[str, object]]:
    """Give every thing a place apart from the others; names of sides lie on their side, a cable is one line."""
    for _ in range(400):
        spots: list[tuple[float, float]] = []
        placed: list[dict[str, object]] = []
        line = _line(rng)
        cable = [at[:2] for at in line.values()] if ("cable-1", "cable") in things else []
        for k in rng.permutation(len(things)).tolist():
            name, kind = things[k]
            yaw = float(rng.uniform(-math.pi, math.pi))
            if kind.startswith("cable"):
                x, y, yaw = line["damage" if kind == "cable-damage" else name]
            elif (found := _spot(name, [*spots, *cable], rng)) is None:
                break
            else:
                x, y = found
                spots.append(found)
            placed.append({"name": name, "kind": kind, "x": round(x, 2), "y": round(y, 2), "yaw": round(yaw, 2)})
        if len(placed) == len(things):
            return placed
    raise AssertionError("no room for the things of a mission")


def _spot(name: str, spots: Sequence[tuple[float, float]], rng: np.random.Generator) -> tuple[float, float] | None:
    for _ in range(60):
        x, y = (float(rng.uniform(EDGE_M, edge - EDGE_M)) for edge in SIZE_M)
        side = name.partition("-")[0]
        there = {
            "north": y > 13.5 and x < 19.0,
            "south": y < 6.5 and x < 19.0,
            "east": x > (20.0 if name == "east" else 15.0),
            "west": x < 11.0,
        }.get(side, True)
        first = x < START[0] + AHEAD_M and abs(y - START[1]) < AHEAD_HALF_M  # where the robot goes unasked
        far = math.dist((x, y), START) >= FROM_START_M and not first
        if there and far and all(math.dist((x, y), spot) >= APART_M for spot in spots):
            return x, y
    return None


def _line(rng: np.random.Generator) -> dict[str, tuple[float, float, float]]:
    """Return the places of a cable's pieces and of its damage, in line; it does not continue behind the damage."""
    yaw = float(rng.uniform(-0.9, 0.9))
    x, y = float(rng.uniform(6.5, 8.0)), float(rng.uniform(7.0, 13.0))
    at = [(x + 2.1 * k * math.cos(yaw), y + 2.1 * k * math.sin(yaw), yaw) for k in range(5)]
    return {**{f"cable-{k + 1}": at[k] for k in range(4)}, "damage": at[4]}


def _animals(
    number: int, family: str, placed: Sequence[dict[str, object]], homes: Mapping[str, str]
) -> list[dict[str, object]]:
    """Return the animals, drawn apart from all else, or at the things that are their homes by name."""
    rng = np.random.default_rng([crc32(family.encode()), number, 1])
    low, high = np.full(2, ROOM_M), np.array(SIZE_M) - ROOM_M
    places = [(kind, *rng.uniform(low, high).round(2).tolist(), rng.uniform(-3.1, 3.1)) for kind in ANIMALS]
    free = {kind: {"name": kind, "kind": kind, "x": x, "y": y, "yaw": round(yaw, 2)} for kind, x, y, yaw in places}
    at = {str(one["name"]): {"x": one["x"], "y": one["y"]} for one in placed}
    return [{**free[kind], **(at[homes[kind]] if kind in homes else {})} for kind in ANIMALS]


def _posts(placed: Sequence[dict[str, object]], rng: np.random.Generator) -> list[dict[str, object]]:
    """Return a few posts to keep clear of."""
    posts: list[dict[str, object]] = []
    spots = [(float(str(one["x"])), float(str(one["y"]))) for one in placed] + [START]
    for _ in range(200):
        x, y = (round(float(rng.uniform(EDGE_M, edge - EDGE_M)), 2) for edge in SIZE_M)
        if len(posts) < POSTS and all(math.dist((x, y), spot) >= FROM_POST_M for spot in spots):
            posts.append({"shape": "cylinder", "x": x, "y": y, "z": 1.1, "size": (0.14, 0.14, 1.1)})
            spots.append((x, y))
    return posts
