"""The reef questions of a set; their key is the time that each answer costs on the true map."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from coral.exam.item import ExamItem
from coral.exam.reef_moments import Moment, moments
from coral.exam.reef_regret import INSPECTED_M, TrueReef
from coral.reef.world.generate import GeneratorCfg, generate
from coral.reef.world.geometry import to_robot
from coral.reef.world.spines import TOPOLOGIES
from coral.reef.world.world import ReefWorld, load_world

PER_WORLD: Mapping[str, int] = {"reef-centroid": 4, "reef-waypoint": 3}
"""Maximum number of questions of each kind from one world."""
LEAST_DOTS = 3
TELLING_S = 6.0
"""The accepted answers must differ by this much, unless most answers are refused."""


def reef_items(
    seed: int, generated: int, shipped: tuple[str, ...], say: Callable[[str], None] = lambda text: None
) -> list[ExamItem]:
    """Make the questions of both kinds, their best answers spread evenly over the directions.

    Args:
        seed: Of the paths through the worlds and of the generated worlds.
        generated: Number of reefs to generate besides the shipped ones.
        shipped: Names of the shipped reefs to use.
        say: Receives a message after each world.
    """
    worlds = [load_world(name) for name in shipped]
    worlds += [_world(seed, k) for k in range(generated)]
    found: list[tuple[str, str, Moment, dict[str, float | str]]] = []
    for number, world in enumerate(worlds):
        reef, rng = TrueReef(world), np.random.default_rng([seed, 31, number])
        kept: dict[str, list[tuple[Moment, dict[str, float | str]]]] = {kind: [] for kind in PER_WORLD}
        for moment in moments(world, reef.clusters, rng, INSPECTED_M):
            seconds = _seconds(reef, moment)
            if _answers_differ(moment, seconds):
                kept[moment.question.kind].append((moment, seconds))
        for kind, all_of in kept.items():
            found += [(kind, world.name, *one) for one in _spread_over_directions(all_of, PER_WORLD[kind])]
        say(f"{world.name}: {', '.join(f'{len(of_kind)} {kind}' for kind, of_kind in kept.items())} questions kept")
    return [
        ExamItem(
            id=f"{kind}-{number:03d}",
            kind=kind,
            group=world,
            prompt=moment.question.prompt,
            prompt_version=moment.question.prompt_version,
            facts=moment.question.facts,
            pictures=moment.question.pictures,
            asked_at_s=moment.question.asked_at_s,
            key={"seconds": seconds},
        )
        for kind in PER_WORLD
        for number, (_, world, moment, seconds) in enumerate(one for one in found if one[0] == kind)
    ]


def _world(seed: int, number: int) -> ReefWorld:
    topology = sorted(TOPOLOGIES)[number % len(TOPOLOGIES)]
    edge = (20.0, 22.0, 24.0, 26.0)[number % 4]
    cfg = GeneratorCfg(topology=topology, size_m=(edge, edge), clusters=6 + number % 3, seed=1000 * seed + number)
    return generate(cfg)


def _seconds(reef: TrueReef, moment: Moment) -> dict[str, float | str]:
    """Compute the time of each accepted answer (s), and the code of refusal of the others."""
    points = {answer: point for answer, point in moment.options.items() if not isinstance(point, str)}
    costs = reef.seconds(moment.pose, np.array(list(points.values())).reshape(-1, 2), moment.left)
    taken = {
        answer: round(float(cost), 1) if math.isfinite(cost) else "blocked"
        for answer, cost in zip(points, costs, strict=True)
    }
    return {
        answer: taken.get(answer, point if isinstance(point, str) else "") for answer, point in moment.options.items()
    }


def _answers_differ(moment: Moment, seconds: Mapping[str, float | str]) -> bool:
    """Check whether the answers to a question differ enough to tell good advisors from bad ones."""
    taken = [cost for cost in seconds.values() if not isinstance(cost, str)]
    if not taken:
        return False
    if moment.question.kind == "reef-centroid" and len(seconds) < LEAST_DOTS:
        return False
    return max(taken) - min(taken) >= TELLING_S or 2 * len(taken) <= len(seconds)


def _spread_over_directions(
    found: list[tuple[Moment, dict[str, float | str]]], count: int
) -> list[tuple[Moment, dict[str, float | str]]]:
    """Select moments of a world whose best answers point in as many directions as possible, in their order."""
    by_side: dict[int, list[int]] = {}
    for k, (moment, seconds) in enumerate(found):
        by_side.setdefault(_best_octant(moment, seconds), []).append(k)
    chosen: list[int] = []
    while len(chosen) < count and any(by_side.values()):
        for side in sorted(by_side, key=lambda side: (len(by_side[side]), side)):
            if by_side[side] and len(chosen) < count:
                # Start in the middle of the path: most is known there, and some clusters are left.
                chosen.append(by_side[side].pop(len(by_side[side]) // 2))
    return [found[k] for k in sorted(chosen)]


def _best_octant(moment: Moment, seconds: Mapping[str, float | str]) -> int:
    """Return the octant of the best answer's direction, relative to the heading."""
    best = min((cost, answer) for answer, cost in seconds.items() if not isinstance(cost, str))[1]
    point = moment.options[best]
    assert not isinstance(point, str)
    forward, left = to_robot(moment.pose, *point)
    return round(math.atan2(left, forward) / (math.pi / 4)) % 8
