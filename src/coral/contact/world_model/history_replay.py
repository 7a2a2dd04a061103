"""Windows of a history that tell of an object, and their replay under a belief, compared with what was measured."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.control.rollouts import SLEEP
from coral.contact.scene.geometry import angle_between
from coral.contact.scene.observation import Array, Observation, Transition
from coral.contact.scene.trial import PhysicalParameters

POSITION_M = 0.0005
"""Unit of the object's position error."""
ANGLE_RAD = 0.01
"""Unit of the object's angle error."""
SPEED_M_S = 0.03
"""Unit of the object's speed error."""
HAND_M = 0.0002
"""Unit of the tool's position error."""
FORCE_N = 0.5
"""Unit of the error of the mean force on the hand, plus `force_share` of the measured force."""
FORCE_SHARE = 0.3
"""Relative part of that unit."""
MOST = 6.0
"""Errors are clipped at this many units: one slipped contact must not decide."""

COMPARED = 6
"""Maximum number of windows that a question shows."""
LENGTH, MOST_WINDOWS = 12, 14
"""Steps of a window, and the maximum number of windows: few steps, because a rollout of contact diverges from the world
within tenths of a second."""
MOVED_M, TOUCHED_N = 0.0005, 0.3
"""A window in which the object moved less, and the hand near it felt less, is ignored."""
NEAR_M = 0.25


Window = Sequence[Transition]
"""Consecutive steps."""


class HistoryReplay:
    """Replays windows of a history under many beliefs at once."""

    def __init__(self, world: PlanningWorld, windows: Sequence[Window]) -> None:
        self.world, self.windows = world, list(windows)
        self.world.edges = True

    def parts(self, beliefs: Sequence[Mapping[str, PhysicalParameters]], name: str) -> Array:
        """Compute root mean square errors in their units, Shape=(beliefs, windows, kinds); inf if a replay diverges."""
        self.world.believe(list(beliefs))
        for model in self.world.models:
            # A replay can afford more than planning: contacts that neither creep nor chatter, and no sleeping of
            # objects that hardly move.
            model.opt.cone, model.opt.impratio, model.opt.iterations = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0, 50
            model.opt.enableflags &= ~SLEEP
        return np.stack([self._parts(window, name, len(beliefs)) for window in self.windows], axis=1)

    def score(self, parts: Array, floor: Array) -> Array:
        """Compute the mean squared error of each belief in each window, Shape=(beliefs, windows).

        `floor`, Shape=(windows, kinds), is the error that no belief explains. A kind of error with a high floor, from
        the coarse rollout or the arm's dynamics, has less weight. A window that diverges under every belief is ignored.
        """
        share = np.full(parts.shape, np.inf)
        np.divide(parts, 1.0 + floor, out=share, where=np.broadcast_to(np.isfinite(floor), parts.shape))
        return np.asarray(np.square(np.minimum(share, MOST)).mean(axis=-1))

    def controls(self, window: Window) -> ControlSequences:
        """Return the commands of a window as one control sequence."""
        stiffness = float(np.median([step.command.stiffness for step in window]))
        # A rollout has constant stiffness and no added force: both become displacements with the same pull.
        position = np.array([_pulled_position(step, stiffness) for step in window])
        return ControlSequences(
            position[None],
            np.array([step.command.quaternion for step in window])[None],
            np.array([[step.command.opening_m for step in window]]),
            stiffness,
        )

    def _parts(self, window: Window, name: str, count: int) -> Array:
        states, sane = self.world.rollout(window[0].before, self.controls(window))
        measured = [step.after.objects[name] for step in window]
        place = np.array([body.position for body in measured])
        turn = np.array([body.quaternion for body in measured])
        speed = np.array([body.velocity for body in measured])
        hand = np.array([step.after.tool.position for step in window])
        force = np.array([step.after.wrench[:3] for step in window])
        shape = (count, len(window))
        felt = np.broadcast_to(states.ee_force, (*shape, 3)).mean(axis=1) - force.mean(axis=0)
        unit = FORCE_N + FORCE_SHARE * float(np.linalg.norm(force.mean(axis=0)))
        ahead = np.linalg.norm((states.ee_pos - hand).mean(axis=1), axis=-1)
        found = np.stack(
            [
                _rms(np.linalg.norm(states[f"{name}_pos"] - place, axis=-1)) / POSITION_M,
                _rms(angle_between(states[f"{name}_quat"], np.broadcast_to(turn, (*shape, 4)))) / ANGLE_RAD,
                _rms(np.linalg.norm(states[f"{name}_vel"] - speed, axis=-1)) / SPEED_M_S,
                ahead / HAND_M,
                np.linalg.norm(felt, axis=-1) / unit,
            ],
            axis=-1,
        )
        return np.where(sane[:, None], found, np.inf)


def compare_motions(
    replay: HistoryReplay, name: str, believed: Mapping[str, PhysicalParameters]
) -> list[dict[str, Any]]:
    """Replay the first windows of a history, and compare the object's motion with the measured one.

    Windows that diverge are left out.
    """
    replay.world.believe([believed])
    rows: list[dict[str, Any]] = []
    for window in replay.windows[:COMPARED]:
        states, sane = replay.world.rollout(window[0].before, replay.controls(window))
        if not sane[0]:
            continue
        before, after = window[0].before.objects[name], window[-1].after.objects[name]
        force = np.mean([step.after.wrench[:3] for step in window], axis=0)
        end = np.asarray(states[f"{name}_quat"])[0, -1]
        rows.append(
            {
                "from_s": round(window[0].before.time_s, 2),
                "to_s": round(window[-1].after.time_s, 2),
                "expected_moved_mm": _tenths(1e3 * (np.asarray(states[f"{name}_pos"])[0, -1] - before.position)),
                "measured_moved_mm": _tenths(1e3 * (after.position - before.position)),
                "expected_turned_deg": round(float(np.degrees(angle_between(end, before.quaternion))), 1),
                "measured_turned_deg": round(float(np.degrees(angle_between(after.quaternion, before.quaternion))), 1),
                "expected_force_n": _tenths(np.asarray(states["ee_force"])[0].mean(axis=0)),
                "measured_force_n": _tenths(force),
            }
        )
    return rows


def _tenths(values: Array) -> list[float]:
    return [round(float(value), 1) + 0.0 for value in values]


def _rms(error: Array) -> Array:
    """Compute the root mean square over the steps, Shape=(beliefs, steps) to Shape=(beliefs,)."""
    return np.asarray(np.sqrt(np.square(error).mean(axis=1)))


def _pulled_position(step: Transition, stiffness: float) -> Array:
    tool, command = step.before.tool.position, step.command
    return np.asarray(tool + ((command.position - tool) * command.stiffness + command.force) / stiffness)


def windows(
    steps: Sequence[Transition], name: str, usable: Callable[[Observation], bool] = lambda start: True
) -> list[Window]:
    """Select the windows of a history in which the object was pushed or slid, the most informative ones, in time order.

    A replay begins only at an observation that is usable.
    """
    found = []
    for first in range(0, len(steps) - LENGTH + 1, LENGTH // 2):
        part = steps[first : first + LENGTH]
        if any(abs(b.before.time_s - a.after.time_s) > 1e-6 for a, b in itertools.pairwise(part)) or not usable(
            part[0].before
        ):
            continue
        way = np.array([step.after.objects[name].position - step.before.objects[name].position for step in part])
        moved = float(np.linalg.norm(way, axis=1).sum())
        force = float(np.mean([np.linalg.norm(step.after.wrench[:3]) for step in part]))
        away = [np.linalg.norm(step.after.objects[name].position - step.after.tool.position) for step in part]
        if moved > MOVED_M or (force > TOUCHED_N and min(away) < NEAR_M):
            found.append((moved + 0.002 * min(force, 5.0), first, part))
    best = sorted(found, key=lambda item: -item[0])[:MOST_WINDOWS]
    return [window for _, _, window in sorted(best, key=lambda item: item[1])]


def most_informative_object(steps: Sequence[Transition]) -> str | None:
    """Return the object that moved farthest, or the one nearest to a hand that felt a force; None without any."""
    if not steps:
        return None
    names = list(steps[0].before.objects)
    moved = {
        name: sum(
            float(np.linalg.norm(step.after.objects[name].position - step.before.objects[name].position))
            for step in steps
        )
        for name in names
    }
    name = max(names, key=lambda one: moved[one])
    if moved[name] > 0.003:
        return name
    felt = max(steps, key=lambda step: float(np.linalg.norm(step.after.wrench[:3])))
    if np.linalg.norm(felt.after.wrench[:3]) < 0.5:
        return None
    tool = felt.after.tool.position
    return min(names, key=lambda one: float(np.linalg.norm(felt.after.objects[one].position - tool)))
