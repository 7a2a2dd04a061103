"""MPPI over spline knots: sample around the last plan, weight by cost, average (Eqs. 4-6 of the CoRAL paper).

Sampling changes a few knots over the horizon; steps between them are interpolated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Fraction, NonNegative, Positive
from coral.mppi.weights import effective_sample_size, softmax_weights

Array = NDArray[np.float64]
Evaluate = Callable[[Array], Array]


@dataclass(frozen=True, kw_only=True)
class KnotMppiCfg:
    """Sampler of the CoRAL paper, over knots."""

    samples: Annotated[int, Field(ge=1, le=100_000)] = 200
    """K (paper, section 4)."""
    temperature: Positive = 0.1
    """lambda (paper, section 4), relative to the spread of the costs, so that it means the same for every cost."""
    knots: Annotated[int, Field(ge=2, le=1000)] = 6
    """Number of sampled values over the horizon; the sequence is interpolated between them."""
    ramp: tuple[NonNegative, NonNegative] = (0.4, 1.4)
    """Factor on the noise at the first and at the last knot: near actions are refined, far ones explored."""
    fine: Fraction = 1.0
    """Share of the samples that end what has nearly been reached: finer ones that perturb some groups of axes only. The
    others explore, with equal noise on all axes, as in the paper. 0: none."""
    finest: Annotated[float, Field(gt=0, le=1)] = 0.1
    """The noise of each fine sample has a factor of its own, from this to 1, evenly in its logarithm."""
    perturbed: Annotated[float, Field(gt=0, le=1)] = 0.5
    """Probability with which a fine sample perturbs a group of axes (at least one): an improvement in one group is not
    lost in the noise of the others."""
    spread_quantile: Positive = 0.5
    """Costs above this quantile are excluded from the spread: one extreme rollout must not flatten the others."""


@dataclass(frozen=True)
class Update:
    """The result of one update."""

    knots: Array
    """Weighted mean of the samples, Shape=(n, nu)."""
    sampled: Array
    """Samples, Shape=(K, n, nu); the first is the previous plan."""
    costs: Array
    """Costs of the samples, Shape=(K,); inf for invalid rollouts."""
    weights: Array
    """Weights of the samples, Shape=(K,)."""
    effective_samples: float
    """Effective sample size, 1 to K."""
    ok: bool
    """False if every rollout was invalid, and the previous plan was kept."""


class KnotMppi:
    """Minimise over knots theta_1 .. theta_n the cost S(u(theta)) of the control sequence that they span.

    S may be any function of rollouts, contacts included; no gradient is needed. Each plan samples
    theta_k ~ N(theta, sigma^2), evaluates S_k, and updates theta <- sum_k w_k theta_k with w = softmax(-S / lambda)
    (Eqs. 4-6). `advance` shifts theta in time for the next plan.

    Args:
        cfg: The sampler.
        sigma: Shape=(nu,) standard deviation of each axis at ramp 1.
        rng: Random generator of the noise.
        groups: Widths of the groups of axes that are perturbed together; by default one group.
    """

    def __init__(
        self, cfg: KnotMppiCfg, sigma: Array, rng: np.random.Generator, groups: Sequence[int] | None = None
    ) -> None:
        self.cfg, self.sigma, self._rng = cfg, np.asarray(sigma, dtype=float), rng
        self._groups = (self.sigma.size,) if groups is None else tuple(groups)
        self.knots = np.zeros((cfg.knots, self.sigma.size))

    def sample(self) -> Array:
        """Sample perturbed plans, Shape=(K, n, nu); the first is the plan itself."""
        cfg = self.cfg
        ramp = np.linspace(*cfg.ramp, cfg.knots)[:, None]
        noise = self._rng.standard_normal((cfg.samples, *self.knots.shape)) * (ramp * self.sigma)
        fine = round(cfg.fine * cfg.samples)
        noise[:fine] *= np.exp(self._rng.uniform(np.log(cfg.finest), 0.0, (fine, 1, 1)))
        noise[:fine] *= self._choose_axes(fine)[:, None, :]
        noise[0] = 0.0
        return np.asarray(self.knots + noise)

    def _choose_axes(self, count: int) -> NDArray[np.bool_]:
        """Choose the axes that each fine sample perturbs, Shape=(count, nu): groups at random, at least one."""
        groups = len(self._groups)
        chosen = self._rng.random((count, groups)) < self.cfg.perturbed
        chosen[np.arange(count), self._rng.integers(groups, size=count)] |= ~chosen.any(axis=1)
        return np.repeat(chosen, self._groups, axis=1)

    def improve(
        self,
        evaluate: Evaluate,
        proposals: Callable[[Array], Array] | None = None,
        bound: Callable[[Array], Array] = lambda knots: knots,
    ) -> Update:
        """Improve the plan: sample, evaluate, average.

        Args:
            evaluate: Costs, Shape=(K,), of knots, Shape=(K, n, nu); inf or nan for invalid samples.
            proposals: Replaces some of the samples, for example by motions to contact points.
            bound: Projects sequences onto the admissible set.
        """
        cfg, sampled = self.cfg, self.sample()
        if proposals is not None:
            sampled = proposals(sampled)
        sampled = bound(sampled)
        costs = np.asarray(evaluate(sampled), dtype=float)
        costs = np.where(np.isfinite(costs), costs, np.inf)
        weights = softmax_weights(costs, cfg.temperature * spread(costs, cfg.spread_quantile))
        ok = bool(weights.any())
        if ok:
            self.knots = np.tensordot(weights, sampled, axes=1)
        return Update(self.knots.copy(), sampled, costs, weights, effective_sample_size(weights), ok)

    def advance(self, by: float, span: float) -> None:
        """Shift the plan by `by` in time: the warm start of the next one."""
        self.knots = shift(self.knots, by, span)


def spread(costs: Array, quantile: float = 1.0) -> float:
    """Compute the standard deviation of the finite costs up to a quantile; 1 if it vanishes."""
    finite = costs[np.isfinite(costs)]
    if finite.size < 2:
        return 1.0
    kept = finite[finite <= np.quantile(finite, quantile)] if quantile < 1 else finite
    deviation = float(kept.std())
    return deviation if deviation > 1e-9 else 1.0


def basis(times: Array, knots: int, span: float) -> Array:
    """Compute B, Shape=(T, knots), with values(times) = B @ knot values, for knots evenly over [0, span].

    Values are linear between knots, and constant before the first and after the last one.
    """
    return _basis(tuple(np.asarray(times, dtype=float)), knots, float(span))


@lru_cache(maxsize=64)
def _basis(times: tuple[float, ...], knots: int, span: float) -> Array:
    place = np.clip(np.asarray(times) / span, 0.0, 1.0) * (knots - 1)
    left = np.minimum(place.astype(int), max(knots - 2, 0))
    share = place - left
    matrix = np.zeros((len(times), knots))
    rows = np.arange(len(times))
    matrix[rows, left] = 1.0 - share
    if knots > 1:
        matrix[rows, left + 1] += share
    matrix.flags.writeable = False  # the cache returns it again
    return matrix


def interpolate(knots: Array, times: Array, span: float) -> Array:
    """Compute the values, Shape=(..., T, nu), at `times`, Shape=(T,), of splines with knots of Shape=(..., n, nu)."""
    return np.asarray(basis(times, knots.shape[-2], span) @ knots)


def shift(knots: Array, by: float, span: float) -> Array:
    """Shift a spline by `by` in time, Shape=(n, nu): the warm start of the next plan. The last value is held."""
    return interpolate(knots, np.linspace(0.0, span, knots.shape[-2]) + by, span)
