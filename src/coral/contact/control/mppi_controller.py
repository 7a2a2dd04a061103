"""MPPI over targets of the hand, rolled out in the planning world (Eqs. 4-6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Fraction, NonNegative, Positive, Signed
from coral.contact.control.hand_model import FLANGE_TO_TOOL_M, MAX_OPENING_M, SQUEEZE_M
from coral.contact.control.hand_plan import HandPlan, keep_paths
from coral.contact.control.planning_world import ControlSequences, PlanningWorld
from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Guide, Stage
from coral.contact.scene.geometry import column_of, conjugate, from_rotvec, multiply, to_rotvec
from coral.contact.scene.observation import Array, HandTarget, Observation
from coral.errors import InputError
from coral.mppi.knots import KnotMppi, KnotMppiCfg, interpolate

EDGE_M = 0.01
"""A target within this distance of a bound stands at the edge."""
GROUPS = (3, 3, 1)
"""Axes of a knot: position, rotation vector, opening."""


@dataclass(frozen=True, kw_only=True)
class ControllerCfg:
    """Configuration of the controller."""

    horizon: Annotated[int, Field(ge=1, le=10_000)] = 50
    """H control steps (paper, section 4)."""
    mppi: KnotMppiCfg = field(default_factory=lambda: KnotMppiCfg(samples=48))
    """The sampler, with K and lambda. Departs from the paper: 48 fine samples do as well as its 200
    (docs/research/planning.md), which the variant `paper` has, with equal noise."""
    sigma_m: tuple[NonNegative, NonNegative, NonNegative] = (0.04, 0.04, 0.04)
    """Noise on the target's x, y, z (measured to work with and without a table 5 cm below the hand)."""
    sigma_rad: tuple[NonNegative, NonNegative, NonNegative] = (0.12, 0.12, 0.2)
    """Noise on its rotation about x, y, z of the hand."""
    sigma_opening_m: NonNegative = 0.025
    """Noise on the opening."""
    speed_m_s: Positive = 0.5
    turn_rad_s: Positive = 2.5
    opening_m_s: Positive = 0.2
    """Maximum speeds of a target."""
    lead_m: Positive = 0.06
    lead_rad: Positive = 0.5
    """Maximum lead of a target over the measured hand at the start of a plan (no wind-up)."""
    workspace_low_m: tuple[Signed, Signed, Signed] = (-0.35, -0.45, -0.15)
    workspace_high_m: tuple[Signed, Signed, Signed] = (0.4, 0.5, 0.6)
    """Corners of the box that bounds the targets."""
    shoulder_m: tuple[Signed, Signed, Signed] = (-0.5, 0.0, 0.333)
    reach_m: NonNegative = 0.855
    """Centre and radius of a sphere that bounds the wrist: the Panda's shoulder in robosuite, and the reach of its
    flange by its data sheet. 0 disables it. Joint limits and the arm's own links exclude further poses inside."""
    guided: Fraction = 0.2
    """Share of the samples guided to contact points, if a stage has any."""
    terminal: NonNegative = 1.0
    """Weight of the last state (phi of Eq. 4) relative to the mean over the horizon."""
    press_free_n: NonNegative = 10.0
    """Force of the hand on table and fixtures that costs nothing, in stages that keep off these."""
    press_weight: NonNegative = 1.0
    """What 10 N more cost there, in standard deviations of the samples' costs, so that it means the same for every
    cost: among samples that are equally good otherwise, the ones that do not press win. 0: nothing. Departs from the
    paper: its cost is the advisor's alone (0, as under `--variant paper`)."""

    def __post_init__(self) -> None:
        """Check that the corners make a box."""
        if any(low >= high for low, high in zip(self.workspace_low_m, self.workspace_high_m, strict=True)):
            expected = f"numbers below those of workspace_high_m, {list(self.workspace_high_m)}"
            raise InputError("--cfg", "controller.workspace_low_m", list(self.workspace_low_m), expected)


class Controller:
    """Minimise over hand targets u the risk over beliefs of phi(x_H) + mean_t l(x_t), subject to bounds on u.

    l is the stage's cost and phi its value at the last state (Eq. 4); x follows from u by rollouts in the planning
    world, contacts included. u starts at the present target, moves no faster than `speed_m_s`, `turn_rad_s` and
    `opening_m_s`, and stays in the workspace and within the arm's reach. MPPI over knots of u solves the problem: a
    knot is a position in the world, a rotation vector about the present target's orientation, and an opening, so that
    the sampler works on plain vectors and no orientation is singular.
    """

    def __init__(self, world: PlanningWorld, cfg: ControllerCfg, rng: np.random.Generator) -> None:
        self.world, self.cfg, self._rng = world, cfg, rng
        self._sigma = np.array([*cfg.sigma_m, *cfg.sigma_rad, cfg.sigma_opening_m])
        self.mppi = KnotMppi(cfg.mppi, self._sigma, rng, GROUPS)
        self.span_s = cfg.horizon * world.cfg.step_s
        self._times: Array = world.cfg.step_s * np.arange(1.0, cfg.horizon + 1)
        self._target: HandTarget | None = None
        self._centre: Array | None = None

    def reset(self, now: Observation) -> None:
        """See `HandController.reset`."""
        self._target = HandTarget(
            now.tool.position.copy(), now.tool.quaternion.copy(), now.opening_m, self.world.cfg.hand.stiffness_n_m
        )
        self.mppi.knots[:] = np.concatenate([now.tool.position, np.zeros(3), [now.opening_m]])

    def plan(
        self,
        now: Observation,
        stage: Stage,
        step: int,
        since: Observation | None = None,
        target: HandTarget | None = None,
        executed: int = 0,
    ) -> HandPlan:
        """Shift the previous plan by its executed steps, and improve it by rollouts; see `HandController.plan`."""
        if executed:
            self.mppi.advance(executed * self.world.cfg.step_s, self.span_s)
        if self._target is None:
            self.reset(now)
        self._target = target or self._target
        assert self._target is not None
        start = self._bounded_start(now, self._target, stage.stiffness_n_m)
        self._recentre(start)
        self.mppi.sigma = self._sigma * np.asarray(stage.sigma)
        rolled: list[tuple[Context, NDArray[np.bool_], Terms, ControlSequences]] = []

        def evaluate(knots: Array) -> Array:
            controls = self._controls(knots, start.quaternion, stage.stiffness_n_m)
            context, sane = self.world.rollout(now, controls, step, since)
            terms = stage.cost(context)
            rolled[:] = [(context, sane, terms, controls)]
            costs = self._total(terms, context.shape)
            costs[~sane] = np.inf
            return costs + self._pressing(context, costs) if stage.keeps_off else costs

        guides = stage.guides
        propose = None
        if guides and self.cfg.guided > 0:
            present = self.world.present(now, step, since=since)
            aims = [
                (guide, guide.points(present), guide.quaternion(present) if guide.quaternion else None)
                for guide in guides
            ]
            propose = lambda sampled: self._guide_samples(sampled, start, aims)  # noqa: E731
        update = self.mppi.improve(evaluate, propose, lambda knots: self._bound_knots(knots, start))
        context, sane, terms, _ = rolled[0]
        # If every rollout is invalid, the previous plan is kept: it is the first of the samples.
        weights = update.weights if update.ok else np.eye(1, len(update.weights))[0]
        counted = weights > 0  # the others may contain nan
        targets = self._targets(update.knots, start.quaternion, stage.stiffness_n_m)
        return HandPlan(
            targets=targets,
            expected_position=np.tensordot(weights[counted], context.ee_pos[counted], axes=1),
            expected_force=np.tensordot(weights[counted], context.ee_force[counted], axes=1),
            update=update,
            valid=update.ok,
            terms={
                name: float(weights[counted] @ self._total({name: term}, context.shape)[counted])
                for name, term in terms.items()
            },
            now=context.first(),
            diverged=int((~sane).sum()),
            paths=keep_paths(context, sane, weights, self.world.object_names),
            at_edge=self._share_at_edge(targets),
        )

    def _total(self, terms: Terms, shape: tuple[int, int]) -> Array:
        total = np.zeros(shape)
        for term in terms.values():
            total = total + term
        return np.asarray(total.mean(axis=1) + self.cfg.terminal * total[:, -1])

    def _pressing(self, context: Context, costs: Array) -> Array:
        """Compute what each sample pays for pressing the hand on table and fixtures, Shape=(K,)."""
        finite = np.isfinite(costs)
        forces = [np.linalg.norm(context[f"{name}_hand_force"], axis=-1) for name in self.world.fixed_names]
        excess = np.maximum(np.sum(forces, axis=0) - self.cfg.press_free_n, 0.0) / 10.0
        spread = float(np.std(costs[finite])) if finite.any() else 0.0
        return np.asarray(self.cfg.press_weight * spread * excess.mean(axis=1))

    def _bounded_start(self, now: Observation, target: HandTarget, stiffness_n_m: float) -> HandTarget:
        """Return the present target, clipped to the allowed lead over the hand.

        If the stage is stiffer than the one before, the lead shrinks in proportion: the pull stays as it was, where
        the same lead would be a blow.
        """
        share = min(1.0, target.stiffness / stiffness_n_m)
        ahead = share * (target.position - now.tool.position)
        length = float(np.linalg.norm(ahead))
        position = now.tool.position + ahead * min(1.0, self.cfg.lead_m / max(length, 1e-9))
        turn = share * to_rotvec(multiply(conjugate(now.tool.quaternion), target.quaternion))
        angle = float(np.linalg.norm(turn))
        quaternion = multiply(now.tool.quaternion, from_rotvec(turn * min(1.0, self.cfg.lead_rad / max(angle, 1e-9))))
        return HandTarget(position, quaternion, target.opening_m, target.stiffness)

    def _recentre(self, start: HandTarget) -> None:
        knots = self.mppi.knots
        if self._centre is not None:
            absolute = multiply(self._centre, from_rotvec(knots[:, 3:6]))
            knots[:, 3:6] = to_rotvec(multiply(conjugate(start.quaternion), absolute))
        self._centre = start.quaternion

    def _bound_knots(self, knots: Array, start: HandTarget) -> Array:
        """Start knots at the present target and clip them to the speeds, the workspace and the reach."""
        cfg = self.cfg
        knots = knots.copy()
        before = np.tile(np.concatenate([start.position, np.zeros(3), [start.opening_m]]), (len(knots), 1))
        span = self.span_s / (knots.shape[1] - 1)
        knots[:, :1] = before[:, None]
        for k in range(1, knots.shape[1]):
            for part, speed in zip(
                (slice(0, 3), slice(3, 6), slice(6, 7)), (cfg.speed_m_s, cfg.turn_rad_s, cfg.opening_m_s), strict=True
            ):
                move = knots[:, k, part] - before[:, part]
                share = np.minimum(1.0, speed * span / np.maximum(np.linalg.norm(move, axis=-1, keepdims=True), 1e-9))
                knots[:, k, part] = before[:, part] + move * share
            knots[:, k, :3] = np.clip(knots[:, k, :3], cfg.workspace_low_m, cfg.workspace_high_m)
            if cfg.reach_m:
                knots[:, k, :3] = self._pull_into_reach(knots[:, k], start.quaternion)
            knots[:, k, 6] = np.clip(knots[:, k, 6], SQUEEZE_M, MAX_OPENING_M)
            before = knots[:, k]
        return knots

    def _pull_into_reach(self, knots: Array, centre: Array) -> Array:
        """Pull positions, Shape=(K, 3), back where the wrist would be out of the arm's reach."""
        shoulder, reach = np.asarray(self.cfg.shoulder_m), self.cfg.reach_m
        wrist = knots[:, :3] - FLANGE_TO_TOOL_M * column_of(multiply(centre, from_rotvec(knots[:, 3:6])), 2)
        away = wrist - shoulder
        far = np.linalg.norm(away, axis=-1, keepdims=True)
        return np.where(far > reach, knots[:, :3] - away * (1 - reach / np.maximum(far, reach)), knots[:, :3])

    def _share_at_edge(self, targets: Sequence[HandTarget]) -> float:
        """Return the share of targets at the edge of the workspace or of the arm's reach."""
        cfg = self.cfg
        places = np.array([target.position for target in targets])
        turns = np.array([target.quaternion for target in targets])
        at_edge = np.any(
            (places < np.add(cfg.workspace_low_m, EDGE_M)) | (places > np.subtract(cfg.workspace_high_m, EDGE_M)),
            axis=1,
        )
        if cfg.reach_m:
            wrist = places - FLANGE_TO_TOOL_M * column_of(turns, 2)
            at_edge |= np.linalg.norm(wrist - np.asarray(cfg.shoulder_m), axis=1) > cfg.reach_m - EDGE_M
        return float(at_edge.mean())

    def _guide_samples(self, sampled: Array, start: HandTarget, aims: list[tuple[Guide, Array, Array | None]]) -> Array:
        """Replace the last samples by motions to contact points, at a random speed, with half of the noise."""
        chosen = range(len(sampled) - int(self.cfg.guided * len(sampled)), len(sampled))
        times = np.linspace(0.0, 1.0, sampled.shape[1])
        noises = 0.5 * (sampled - self.mppi.knots)
        turns = [
            None if quaternion is None else to_rotvec(multiply(conjugate(start.quaternion), quaternion))
            for _, _, quaternion in aims
        ]
        for row in chosen:
            aim = int(self._rng.integers(len(aims)))
            (guide, points, _), turn, noise = aims[aim], turns[aim], noises[row]
            goal = points[int(self._rng.integers(len(points)))]
            pace = np.minimum(1.0, times * self._rng.uniform(1.0, 3.0))[:, None]
            sampled[row, :, :3] = start.position + pace * (goal - start.position) + noise[:, :3]
            if turn is not None:
                sampled[row, :, 3:6] = pace * turn + noise[:, 3:6]
            if guide.opening_m is not None:
                sampled[row, :, 6] = guide.opening_m + noise[:, 6]
        return sampled

    def _controls(self, knots: Array, centre: Array, stiffness: float) -> ControlSequences:
        values = interpolate(knots, self._times, self.span_s)
        return ControlSequences(
            values[..., :3], multiply(centre, from_rotvec(values[..., 3:6])), values[..., 6], stiffness
        )

    def _targets(self, knots: Array, centre: Array, stiffness: float) -> tuple[HandTarget, ...]:
        controls = self._controls(knots[None], centre, stiffness)
        rows = zip(controls.position[0], controls.quaternion[0], controls.opening[0], strict=True)
        return tuple(HandTarget(position, turn, float(opening), stiffness) for position, turn, opening in rows)
