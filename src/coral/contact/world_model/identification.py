"""Identification (section 3.4, A.5): fit mass and friction so that a replay explains the logged history.

A history determines only some combinations. A slow push reveals the product friction x mass x g; a change of speed
(mass), free sliding (friction) or the weight of a lifted object (mass) separates the two. The fit therefore reports the
standard deviation of each and of the product.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coral.contact.scene.observation import Array
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model.force_balance import Balance, balance_error, solve_balance
from coral.contact.world_model.history_replay import HistoryReplay
from coral.words import many

MASS_KG, FRICTION = (0.02, 5.0), (0.1, 1.5)
"""Bounds of the fit."""
GRID = 6
"""Number of coarse values of each within the bounds, tried first: replay errors have several minima."""
SAMPLES = 20
"""Beliefs per refinement (cross-entropy method on log mass and log friction)."""
ROUNDS = 3
"""Number of refinements."""
ELITE = 0.25
"""Share of the best beliefs, about which the next round samples."""
BETTER = 0.02
"""A correction is accepted if it lowers the error by this share."""
KNOWN = 0.15
"""Relative standard deviation up to which a parameter counts as known."""
MUCH = 0.3
"""A history that determines neither parameter well must lower the error by this share instead."""
DOUBT = (1.0, 0.4)
"""Relative standard deviations of believed mass and friction before any contact: they limit a correction along
directions on which the history has no information."""


@dataclass(frozen=True, kw_only=True)
class IdentifyCfg:
    """Settings of the fit."""

    by: Literal["replay", "balance"] = "replay"
    """Source of corrections: "replay", the fit of replayed commands; "balance", the balance of forces on dragged or
    lifted objects, or the fit if there is none."""


@dataclass(frozen=True)
class Fit:
    """A proposed correction and the evidence for it."""

    object: str
    """Name of the object."""
    before: PhysicalParameters
    after: PhysicalParameters
    """The proposed parameters."""
    error_before: float
    error_after: float
    """Errors of the replay and, if it counts, of the balance of forces."""
    accepted: bool
    """Whether it explains the history better."""
    mass_sd: float
    friction_sd: float
    product_sd: float
    """Relative standard deviations (of log values), from the curvature of the error."""
    windows: int
    """Number of replayed windows."""

    def words(self) -> str:
        """Describe the correction in a sentence."""
        what = (
            f"{self.object}: mass {self.before.mass_kg:.3g} to {self.after.mass_kg:.3g} kg, friction "
            f"{self.before.friction:.2g} to {self.after.friction:.2g}; replay error {self.error_before:.2f} to "
            f"{self.error_after:.2f} in {many(self.windows, 'window')}"
        )
        if max(self.mass_sd, self.friction_sd) <= KNOWN:
            return f"{what}; both are known to {100 * max(self.mass_sd, self.friction_sd):.0f} %"
        if self.product_sd <= KNOWN:
            return f"{what}; only their product is known well: nothing sped up, slid freely or was lifted enough"
        return f"{what}; the history tells little of either"


Found = tuple[PhysicalParameters, tuple[float, float, float]]
"""Mass and friction that explain a history best, and the relative deviations of mass, friction and their product."""


def identify(
    replay: HistoryReplay, name: str, believed: Mapping[str, PhysicalParameters], rng: np.random.Generator
) -> Found:
    """Find the mass m and friction mu of one object that explain a history best.

    Minimise over (log m, log mu), within bounds, the mean squared replay error of every second window (a grid, then
    the cross-entropy method); the correction is accepted on all of them, so that it must hold for unseen ones.
    """
    seen = [True] * len(replay.windows) if len(replay.windows) < 4 else [k % 2 == 0 for k in range(len(replay.windows))]

    def parts(theta: Array) -> Array:
        beliefs = [{**believed, name: PhysicalParameters(float(np.exp(m)), float(np.exp(f)))} for m, f in theta]
        return replay.parts(beliefs, name)

    low = np.log([MASS_KG[0], FRICTION[0]])
    high = np.log([MASS_KG[1], FRICTION[1]])
    present = np.log([believed[name].mass_kg, believed[name].friction])
    axes = [np.linspace(low[k], high[k], GRID) for k in (0, 1)]
    theta = np.concatenate([np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2), present[None]])
    all_theta, found = theta, parts(theta)
    spread = (high - low) / GRID
    for _ in range(ROUNDS):
        score = replay.score(found[:, seen], found.min(axis=0)[seen]).mean(axis=1)
        best = all_theta[np.argsort(score, kind="stable")[: max(2, int(ELITE * SAMPLES))]]
        theta = best[0] + spread * rng.standard_normal((SAMPLES, 2))
        theta[: len(best)] = best.mean(axis=0) + 0.5 * spread * rng.standard_normal(best.shape)
        theta = np.clip(theta, low, high)
        all_theta, found = np.concatenate([all_theta, theta]), np.concatenate([found, parts(theta)])
        spread = 0.6 * spread
    score = replay.score(found[:, seen], found.min(axis=0)[seen]).mean(axis=1)
    optimum, deviations = _find_valley(all_theta, score, low, high)
    return PhysicalParameters(float(np.exp(optimum[0])), float(np.exp(optimum[1]))), deviations


def fit_by_replay(
    replay: HistoryReplay, name: str, believed: Mapping[str, PhysicalParameters], rng: np.random.Generator
) -> Fit:
    """Fit by replay, then shrink towards the belief along directions on which the history has little information.

    Slow pushes determine only the product of mass and friction; fitted freely, a block of 1 kg became one of 4.6 kg
    that slides on ice. Belief and fit are treated as normal in the logarithms; the mean of their product is proposed.
    """
    return shrink_to_belief(identify(replay, name, believed, rng), replay, name, believed)


def fit_by_balance(found: Balance, replay: HistoryReplay, name: str, believed: Mapping[str, PhysicalParameters]) -> Fit:
    """Fit by the balance of forces, shrunk as in `fit_by_replay`; the replay decides whether it is better."""
    after, covariance = solve_balance(found, np.log([MASS_KG, FRICTION]))
    return shrink_to_belief((after, _deviations(covariance)), replay, name, believed, found)


def shrink_to_belief(
    fitted: Found,
    replay: HistoryReplay,
    name: str,
    believed: Mapping[str, PhysicalParameters],
    forces: Balance | None = None,
) -> Fit:
    """Shrink a fit towards the belief; accept it if the replay explains the history better. See `fit_by_replay`.

    With `forces`, balances of forces count as well.
    """
    before, (found, deviations) = believed[name], fitted
    mass_sd, friction_sd, product_sd = deviations
    both = (product_sd**2 - mass_sd**2 - friction_sd**2) / 2
    told = np.array([[mass_sd**2, both], [both, friction_sd**2]])
    doubted = np.diag(np.square(DOUBT))
    old, new = (np.log([one.mass_kg, one.friction]) for one in (before, found))
    mean = old + doubted @ np.linalg.solve(doubted + told, new - old)
    after = PhysicalParameters(float(np.exp(mean[0])), float(np.exp(mean[1])))
    errors = replay_errors(replay, name, believed, {**believed, name: after}, forces)
    # The less well the history determines the parameters, the more the error has to drop.
    accepted = errors[1] < (1.0 - (BETTER if min(deviations) <= KNOWN else MUCH)) * errors[0]
    return Fit(name, before, after, *errors, accepted, *deviations, len(replay.windows))


def replay_errors(
    replay: HistoryReplay,
    name: str,
    believed: Mapping[str, PhysicalParameters],
    proposed: Mapping[str, PhysicalParameters],
    found: Balance | None = None,
) -> tuple[float, float]:
    """Compute the errors of a belief and a proposal: of the replay and, if it counts, of the balance of forces.

    A rolled-out pinch slips where the real one holds, whatever the mass: with a balance, the replay has less weight.
    """
    parts = replay.parts([believed, proposed], name)
    before, after = map(float, replay.score(parts, parts.min(axis=0)).mean(axis=1))
    if found is None or not len(found):
        return before, after
    more = balance_error(found, [believed[name], proposed[name]])
    return before + float(more[0]), after + float(more[1])


def _find_valley(theta: Array, score: Array, low: Array, high: Array) -> tuple[Array, tuple[float, float, float]]:
    """Return the minimum of the error valley, and the relative deviations of mass, friction and their product.

    Chattering contacts make single errors jump; a quadratic through those about the best one smooths them. A deviation
    is the change that raises the error by its scatter about the quadratic, or by a tenth.
    """
    best = theta[int(np.argmin(score))]
    weight = np.exp(-0.5 * np.square((theta - best) / 0.35).sum(axis=1))
    a, b = (theta - best).T
    design = np.stack([np.ones(len(a)), a, b, a * a / 2, a * b, b * b / 2], axis=1)
    root = np.sqrt(weight)[:, None]
    found = np.linalg.lstsq(design * root, score * root[:, 0], rcond=None)[0]
    curvature = np.array([[found[3], found[4]], [found[4], found[5]]])
    values, vectors = np.linalg.eigh(curvature)
    scatter = float(np.sqrt((weight * np.square(score - design @ found)).sum() / weight.sum()))
    allowed = max(scatter, 0.1 * float(score.min()), 1e-6)
    bounded = np.maximum(values, 2 * allowed / 9.0)
    covariance = vectors @ np.diag(2 * allowed / bounded) @ vectors.T
    optimum = best
    if values.min() > 2 * allowed / 9.0:
        step = -np.linalg.solve(curvature, found[1:3])
        length = float(np.linalg.norm(step))
        optimum = np.clip(best + step * min(1.0, 0.35 / max(length, 1e-9)), low, high)
    return optimum, _deviations(covariance)


def _deviations(covariance: Array) -> tuple[float, float, float]:
    """Return the standard deviations of two variables, Shape=(2, 2), and of their sum."""
    one = np.ones(2)
    sd = [float(np.sqrt(v)) for v in (covariance[0, 0], covariance[1, 1], one @ covariance @ one)]
    return sd[0], sd[1], sd[2]
