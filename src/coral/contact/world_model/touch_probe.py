"""Identification experiment: mass and friction of a pushed board, from a belief that is far off (Fig. 4).

The board is pushed slowly (the force reveals friction x mass) and struck so that it slides by itself (its braking
reveals friction), from both ends in turn, in an evaluation world that knows the true values. The fit uses poses and
forces only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Positive
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import HandTarget, Transition
from coral.contact.scene.trial import PhysicalParameters, Trial, with_beliefs
from coral.contact.world_model.history import windows
from coral.contact.world_model.history_replay import HistoryReplay
from coral.contact.world_model.identification import Corrections, Fit, IdentifyCfg
from coral.contact.worlds.evaluation_world import EvaluationWorld
from coral.contact.worlds.registry import make_world

Array = NDArray[np.float64]
ACROSS = np.array([0.0, np.sqrt(0.5), -np.sqrt(0.5), 0.0])
"""Palm down, with the fingers side by side along x."""


@dataclass(frozen=True, kw_only=True)
class ProbeCfg:
    """Settings of the experiment."""

    corrections: Count = 5
    """Number of rounds of pushes, each followed by a correction (paper, Fig. 4: about five)."""
    windows: Count = 10
    """Windows replayed for each correction."""
    replay_dt_s: Positive = 0.002
    """Physics step in replays; the fit needs more accuracy than a rehearsal."""
    slow_m_s: Positive = 0.12
    """Speed of the slow pushes."""
    fast_m_s: Positive = 0.3
    """Speed of the strikes."""
    identify: IdentifyCfg = field(default_factory=IdentifyCfg)
    """Settings of the fit."""


def probe(
    trial: Trial,
    name: str,
    truth: PhysicalParameters,
    first: PhysicalParameters,
    cfg: ProbeCfg,
    rng: np.random.Generator,
    world: str = "hand",
) -> Iterator[Fit]:
    """Push and correct, round by round.

    Args:
        trial: The trial; everything but the true parameters is taken from it.
        name: Name of the object; it is pushed along its y axis.
        truth: Its true parameters.
        first: The prior belief.
        cfg: Settings of the experiment.
        rng: Draws the fits.
        world: The evaluation world.

    Yields:
        Each correction, accepted or not.
    """
    real = make_world(world, with_beliefs(trial, {**_known_parameters(trial), name: truth}), 0.02)
    along = trial.corners(name)[:, 1]
    hand = _Pusher(real, name, float(along.min()), float(along.max()))
    beliefs = {**_known_parameters(trial), name: first}
    planner = PlanningWorld(trial, beliefs, hand.now, PlanningCfg(physics_dt_s=cfg.replay_dt_s, threads=1))
    known = Corrections()
    try:
        for turn in range(cfg.corrections):
            hand.steps.clear()
            for end, speed in ((1.0, cfg.slow_m_s), (-1.0, cfg.fast_m_s), (1.0, cfg.fast_m_s), (-1.0, cfg.slow_m_s)):
                # Alternate the direction so that the board stays in place.
                hand.push(end * (1.0 if turn % 2 == 0 else -1.0), speed)
            replay = HistoryReplay(planner, windows(hand.steps, name, most=cfg.windows), cfg.identify.replay)
            fit = known.add(replay, name, beliefs, cfg.identify, rng)
            if fit.accepted:
                beliefs = {**beliefs, name: fit.after}
            yield fit
    finally:
        planner.close()
        real.close()


def _known_parameters(trial: Trial) -> dict[str, PhysicalParameters]:
    return {name: item.physical for name, item in trial.objects.items()}


class _Pusher:
    """Moves the hand along straight lines and records the history."""

    def __init__(self, world: EvaluationWorld, name: str, rear_m: float, front_m: float) -> None:
        self._world, self._name, self._rear, self._front = world, name, rear_m, front_m
        self.now = world.reset()
        self.steps: list[Transition] = []

    def push(self, end: float, speed: float) -> None:
        """Move to one end, push it by a few centimetres, and draw back."""
        here = self.now.tool.position
        self._go([here[0], here[1], 0.12], 12, 1.0)
        body = self.now.objects[self._name]
        tip = body.position + rotate(body.quaternion, [0.0, self._rear if end > 0 else self._front, 0.0])
        self._go([tip[0], tip[1] - 0.04 * end, 0.12], 36, 1.2)
        self._go([tip[0], tip[1] - 0.03 * end, 0.012], 20, 0.8)
        self._go([tip[0], tip[1] + 0.08 * end, 0.012], int(0.11 / speed / 0.02) + 1, speed)
        self._go([tip[0], tip[1] - 0.08 * end, 0.012], 14, 3.0)

    def _go(self, target: list[float], count: int, speed: float) -> None:
        start = self.now.tool.position.copy()
        way: Array = np.asarray(target, dtype=float) - start
        length = max(float(np.linalg.norm(way)), 1e-9)
        for k in range(count):
            position = start + way * min(1.0, (k + 1) * speed * self._world.control_period_s / length)
            command = HandTarget(position, ACROSS, 0.07, 600.0)
            before, self.now = self.now, self._world.step(command)
            self.steps.append(Transition(before, command, self.now))
