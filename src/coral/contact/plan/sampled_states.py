"""States sampled by rollouts in the planning world: for checking costs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.cost.context import Context
from coral.contact.plan.contact_regions import PAD_M, tool_quaternion
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, rotation_of, to_rotvec
from coral.contact.scene.observation import Array, BodyState, Observation

ABOVE_M = 0.06
RANDOM, HORIZON = 24, 60
"""Number of random rollouts, and control steps of every rollout."""
COMMON_SEED = 20_260
"""Seed of the random paths on which every program is checked."""
DOWNWARD = np.array([0.0, 0.0, -1.0])


def sample_states(world: PlanningWorld, now: Observation, sizes: Mapping[str, Array]) -> Context:
    """Sample rolled-out states around the hand and the objects, varied enough to tell good futures from bad ones.

    Half of them approach the objects: each from above, pressed down on, and down beside each side and against it. The
    others are random, but the same ones at every call (common random numbers): one program gets one verdict.
    """
    rng = np.random.default_rng(COMMON_SEED)
    paths = [path for name, body in now.objects.items() for path in _approach_paths(body, np.asarray(sizes[name]), now)]
    paths += [_random_path(now, rng) for _ in range(RANDOM)]
    share = np.linspace(0, 1, HORIZON)
    position = np.stack([_interpolate_path(now.tool.position, path[0], share) for path in paths])
    quaternion = np.stack([_interpolate_rotation(now.tool.quaternion, path[1], share) for path in paths])
    opening = np.stack([now.opening_m + (path[2] - now.opening_m) * np.minimum(1, 2 * share) for path in paths])
    context, _ = world.rollout(now, ControlSequences(position, quaternion, opening, world.cfg.hand.stiffness_n_m))
    return context


ToolPath = tuple[list[Array], Array, float]


def _approach_paths(body: BodyState, size: Array, now: Observation) -> list[ToolPath]:
    rotation = rotation_of(body.quaternion)
    up = int(np.argmax(np.abs(rotation[2])))
    top = body.position + np.array([0, 0, size[up] / 2])
    over = top + np.array([0, 0, ABOVE_M])
    paths: list[ToolPath] = [([over, top, top - np.array([0, 0, 0.02])], now.tool.quaternion, 0.0)]
    for axis in (k for k in range(3) if k != up):
        side = rotation[:, axis]
        if size[axis] < MAX_OPENING_M - 0.004:
            grasp = body.position + np.array([0, 0, max(0.0, size[up] / 2 - 0.025, 0.012 - size[up] / 2)])
            turn = tool_quaternion(DOWNWARD, side, now.tool.quaternion)
            paths.append(([over, grasp, grasp], turn, MAX_OPENING_M))
        for sign in (1.0, -1.0):
            turn = tool_quaternion(DOWNWARD, np.cross(side, DOWNWARD), now.tool.quaternion)
            for high in (-0.6, 0.6):
                face = body.position + sign * side * (size[axis] / 2 + PAD_M) + np.array([0, 0, high * size[up] / 2])
                face[2] = max(face[2], 0.012)
                beside = face + sign * side * 0.02
                high_up = np.array([beside[0], beside[1], top[2] + ABOVE_M])
                paths.append(([high_up, beside, face - sign * side * 0.06], turn, 0.03))
    return paths


def _random_path(now: Observation, rng: np.random.Generator) -> ToolPath:
    places = [now.tool.position, *(body.position for body in now.objects.values())]
    first = places[int(rng.integers(len(places)))] + rng.normal(0, [0.07, 0.07, 0.05])
    second = first + rng.normal(0, [0.06, 0.06, 0.03])
    path = [np.maximum(point, [-1.0, -1.0, 0.01]) for point in (first, second)]
    turn = multiply(now.tool.quaternion, from_rotvec(rng.normal(0, 0.3, 3)))
    return path, turn, float(rng.uniform(0, MAX_OPENING_M))


def _interpolate_path(start: Array, path: list[Array], share: Array) -> Array:
    points = np.stack([start, *path])
    at = share * len(path)
    return np.stack([np.interp(at, np.arange(len(points)), points[:, k]) for k in range(3)], axis=1)


def _interpolate_rotation(start: Array, end: Array, share: Array) -> Array:
    turn = to_rotvec(multiply(conjugate(start), end))
    return multiply(start, from_rotvec(np.minimum(1, 3 * share)[:, None] * turn))
