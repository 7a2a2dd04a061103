"""The reef's questions of a set, with the seconds that each answer costs on the true map as their key."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from coral.exam.item import ExamItem
from coral.exam.reef_moments import Moment, moments
from coral.exam.reef_regret import INSPECTED_M, TrueReef
from coral.reef.generate import GeneratorCfg, generate
from coral.reef.geometry import to_robot
from coral.reef.spines import TOPOLOGIES
from coral.reef.world import ReefWorld, load_world

PER_WORLD: Mapping[str, int] = {"reef-centroid": 4, "reef-waypoint": 3}
"""Questions of each kind from one world at most."""
LEAST_DOTS = 3
TELLING_S = 6.0
"""Answers that the verifiers take have to differ by so much, unless most answers are refused."""


def reef_items(
    seed: int, generated: int, shipped: tuple[str, ...], say: Callable[[str], None] = lambda text: None
) -> list[ExamItem]:
    """Questions of both kinds, those of each kind as evenly as possible about the direction of the best answer.

    Args:
        seed: Of the ways through the worlds and of the generated worlds.
        generated: How many reefs to generate besides the shipped ones.
        shipped: Names of shipped reefs.
        say: Told of each world that is done.
    """
    worlds = [load_world(name) for name in shipped]
    worlds += [_world(seed, k) for k in range(generated)]
    found: list[tuple[str, str, Moment, dict[str, float | str]]] = []
    for number, world in enumerate(worlds):
        reef, rng = TrueReef(world), np.random.default_rng([seed, 31, number])
        kept: dict[str, list[tuple[Moment, dict[str, float | str]]]] = {kind: [] for kind in PER_WORLD}
        for moment in moments(world, reef.clusters, rng, INSPECTED_M):
            seconds = _seconds(reef, moment)
            if _tells(moment, seconds):
                kept[moment.question.kind].append((moment, seconds))
        for kind, all_of in kept.items():
            found += [(kind, world.name, *one) for one in _spread(all_of, PER_WORLD[kind])]
        say(f"{world.name}: {', '.join(f'{len(of_kind)} {kind}' for kind, of_kind in kept.items())} questions tell")
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
    """Seconds of each answer that the verifiers take, and the code of refusal of the others."""
    points = {answer: point for answer, point in moment.options.items() if not isinstance(point, str)}
    costs = reef.seconds(moment.pose, np.array(list(points.values())).reshape(-1, 2), moment.left)
    taken = {
        answer: round(float(cost), 1) if math.isfinite(cost) else "blocked"
        for answer, cost in zip(points, costs, strict=True)
    }
    return {
        answer: taken.get(answer, point if isinstance(point, str) else "") for answer, point in moment.options.items()
    }


def _tells(moment: Moment, seconds: Mapping[str, float | str]) -> bool:
    """Whether good and bad answers to a question differ enough to be worth asking."""
    taken = [cost for cost in seconds.values() if not isinstance(cost, str)]
    if not taken:
        return False
    if moment.question.kind == "reef-centroid" and len(seconds) < LEAST_DOTS:
        return False
    return max(taken) - min(taken) >= TELLING_S or 2 * len(taken) <= len(seconds)


def _spread(
    found: list[tuple[Moment, dict[str, float | str]]], count: int
) -> list[tuple[Moment, dict[str, float | str]]]:
    """Some moments of a world whose best answers lie in as many directions as possible, in their order."""
    by_side: dict[int, list[int]] = {}
    for k, (moment, seconds) in enumerate(found):
        by_side.setdefault(_side(moment, seconds), []).append(k)
    chosen: list[int] = []
    while len(chosen) < count and any(by_side.values()):
        for side in sorted(by_side, key=lambda side: (len(by_side[side]), side)):
            if by_side[side] and len(chosen) < count:
                # From the middle of the way: there most is known and something is left.
                chosen.append(by_side[side].pop(len(by_side[side]) // 2))
    return [found[k] for k in sorted(chosen)]


def _side(moment: Moment, seconds: Mapping[str, float | str]) -> int:
    """Eighth of the circle in which the best answer lies, from the heading."""
    best = min((cost, answer) for answer, cost in seconds.items() if not isinstance(cost, str))[1]
    point = moment.options[best]
    assert not isinstance(point, str)
    forward, left = to_robot(moment.pose, *point)
    return round(math.atan2(left, forward) / (math.pi / 4)) % 8
