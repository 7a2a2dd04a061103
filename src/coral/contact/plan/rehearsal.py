"""Trying things out in the planning world before they are relied on: states for checking costs, and what they gain."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Stage
from coral.contact.plan.contact_regions import PAD_M, tool_quaternion
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, rotation_of, to_rotvec
from coral.contact.scene.observation import BodyState, Observation

Array = NDArray[np.float64]
ABOVE_M = 0.06
HALF_TURN = np.array([0.0, 0.0, 0.0, 1.0])
"""About the palm's axis."""
DOWNWARD = np.array([0.0, 0.0, -1.0])


def sample_states(
    world: PlanningWorld,
    now: Observation,
    sizes: Mapping[str, Array],
    rng: np.random.Generator,
    count: int = 24,
    horizon: int = 60,
) -> list[Context]:
    """Rolled-out states around the hand and the objects, varied enough to tell good futures from bad ones.

    Half of them go where a hand can go: around each object from above, and down beside each of its sides and against
    it. The others go anywhere. Without the former a check of what can be reached would judge by bad luck.

    Args:
        world: The planning world, as it believes.
        now: Where the rollouts begin.
        sizes: Full extents of the objects, m.
        rng: Chooses the ways.
        count: Rollouts that go anywhere.
        horizon: Control steps of each.
    """
    ways = _some(now, sizes, rng, count)
    share = np.linspace(0, 1, horizon)
    position = np.stack([_along(now.tool.position, way[0], share) for way in ways])
    quaternion = np.stack([_turning(now.tool.quaternion, way[1], share) for way in ways])
    opening = np.stack([now.opening_m + (way[2] - now.opening_m) * np.minimum(1, 2 * share) for way in ways])
    context, _ = world.rollout(now, ControlSequences(position, quaternion, opening, world.cfg.hand.stiffness_n_m))
    return [context]


Way = tuple[list[Array], Array, float]


def _some(now: Observation, sizes: Mapping[str, Array], rng: np.random.Generator, count: int) -> list[Way]:
    """Ways where a hand can go, then some that go anywhere."""
    ways = [way for name, body in now.objects.items() for way in _around(body, np.asarray(sizes[name]), now)]
    return ways + [_anywhere(now, rng) for _ in range(count)]


def _around(body: BodyState, size: Array, now: Observation) -> list[Way]:
    rotation = rotation_of(body.quaternion)
    up = int(np.argmax(np.abs(rotation[2])))
    top = body.position + np.array([0, 0, size[up] / 2])
    found: list[Way] = []
    for axis in (k for k in range(3) if k != up):
        side = rotation[:, axis]
        if size[axis] < MAX_OPENING_M - 0.004:
            grasp = body.position + np.array([0, 0, max(0.0, size[up] / 2 - 0.025, 0.012 - size[up] / 2)])
            turn = tool_quaternion(DOWNWARD, side, now.tool.quaternion)
            found.append(([top + np.array([0, 0, ABOVE_M]), grasp, grasp], turn, MAX_OPENING_M))
        for sign in (1.0, -1.0):
            turn = tool_quaternion(DOWNWARD, np.cross(side, DOWNWARD), now.tool.quaternion)
            for high in (-0.6, 0.6):
                face = body.position + sign * side * (size[axis] / 2 + PAD_M) + np.array([0, 0, high * size[up] / 2])
                face[2] = max(face[2], 0.012)
                beside = face + sign * side * 0.02
                over = np.array([beside[0], beside[1], top[2] + ABOVE_M])
                found.append(([over, beside, face - sign * side * 0.06], turn, 0.03))
    return found


def _anywhere(now: Observation, rng: np.random.Generator) -> Way:
    places = [now.tool.position, *(body.position for body in now.objects.values())]
    first = places[int(rng.integers(len(places)))] + rng.normal(0, [0.07, 0.07, 0.05])
    second = first + rng.normal(0, [0.06, 0.06, 0.03])
    way = [np.maximum(point, [-1.0, -1.0, 0.01]) for point in (first, second)]
    turn = multiply(now.tool.quaternion, from_rotvec(rng.normal(0, 0.3, 3)))
    return way, turn, float(rng.uniform(0, MAX_OPENING_M))


def _along(start: Array, way: list[Array], share: Array) -> Array:
    points = np.stack([start, *way])
    at = share * len(way)
    return np.stack([np.interp(at, np.arange(len(points)), points[:, k]) for k in range(3)], axis=1)


def _turning(start: Array, end: Array, share: Array) -> Array:
    turn = to_rotvec(multiply(conjugate(start), end))
    return multiply(start, from_rotvec(np.minimum(1, 3 * share)[:, None] * turn))


def rehearsed_gain(
    world: PlanningWorld,
    stage: Stage,
    now: Observation,
    sizes: Mapping[str, Array],
    rng: np.random.Generator,
    horizon: int = 50,
    count: int = 24,
) -> float:
    """Share by which the best of some rehearsed ways lowers a stage's cost against keeping still; 1 is all of it.

    Args:
        world: The planning world.
        stage: Its guides give the ways; without any they are those of `sample_states`.
        now: Where the rehearsals begin.
        sizes: Full extents of the objects, m.
        rng: Chooses the ways where there are no guides; not drawn from otherwise.
        horizon: Control steps.
        count: Of the ways without guides, how many go anywhere.
    """
    present = world.present(now)
    start = now.tool
    ways: list[Way] = []
    for guide in stage.guides:
        turn = np.asarray(guide.quaternion(present) if guide.quaternion else start.quaternion)
        opening = now.opening_m if guide.opening_m is None else guide.opening_m
        # Either way round: the fingers touch alike, and a cost may ask for one.
        ways += [
            ([point], way, float(opening))
            for way in (turn, multiply(turn, HALF_TURN))
            for point in guide.points(present)
        ]
    if not stage.guides:
        ways = _some(now, sizes, rng, count)
    ways.append(([start.position], start.quaternion, now.opening_m))
    share = np.linspace(0, 1, horizon)
    controls = ControlSequences(
        np.stack([_along(start.position, way[0], np.minimum(1, 1.5 * share)) for way in ways]),
        np.stack([_turning(start.quaternion, way[1], share) for way in ways]),
        np.stack([now.opening_m + (way[2] - now.opening_m) * np.minimum(1, 2 * share) for way in ways]),
        stage.stiffness_n_m,
    )
    states, sane = world.rollout(now, controls)
    terms = stage.cost(states)
    total = np.zeros(states.shape)
    for term in terms.values():
        total = total + term
    cost = np.where(sane, total.mean(axis=1) + total[:, -1], np.inf).reshape(len(world.models), -1).mean(axis=0)
    still, best = float(cost[-1]), float(cost[:-1].min())
    if not np.isfinite([still, best]).all():  # nothing can be told from rehearsals that diverged
        return 0.0
    return (still - best) / max(abs(still), 1e-9)
