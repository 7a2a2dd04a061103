"""Measures the calibration of a network's oysters on surveys of simulated reefs, whose truth is known."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.map.mapping import distance_to
from coral.reef.products.cover import CoverCfg, collect_votes, fine_of, locate_gaps, make_cover, sum_votes
from coral.reef.products.cover_calibration import BINS, CoverCalibration, bins_of
from coral.reef.products.truth import true_cover
from coral.reef.recordings.recording import Recording, map_of
from coral.reef.world.world import ReefWorld

BESIDE_M = 0.3
"""Votes within this distance of a cluster's shells are its own, when errors of single clusters are measured."""
LEAST_REEFS = 3


@dataclass(frozen=True)
class AreaEvidence:
    """What a survey found on a piece of sea floor, bin by bin, and the truth: its area is `cells_m2 @ cover`."""

    true_m2: float
    cells_m2: NDArray[np.float64]
    """Sea floor in each bin: mean of what was hit and what is near enough to it (m²). Shape=(BINS,)."""

    def error(self, cover: NDArray[np.float64]) -> float:
        """Return the relative error of the area with a calibration."""
        return float(self.cells_m2 @ cover) / self.true_m2 - 1.0


@dataclass(frozen=True)
class ReefEvidence:
    """What a survey of a reef says about each bin."""

    name: str
    whole: AreaEvidence
    clusters: tuple[AreaEvidence, ...]
    hit: NDArray[np.float64]
    """Number of fine cells with votes. Shape=(BINS,)."""
    shells: NDArray[np.float64]
    """Sum of their true cover. Shape=(BINS,)."""


def gather_evidence(recording: Recording, world: ReefWorld, cfg: CoverCfg) -> ReefEvidence:
    """Compare the votes of a survey with the truth, beside the oysters of its own map, where areas are counted.

    Raises:
        InputError: The recording's pictures have no doubt, or the reef no oysters.
    """
    recording = recording.located()
    if next((one.frame.doubt for one in recording.keyframes()), None) is None:
        raise InputError(recording.source, "doubt", "none", "pictures seen by a network")
    cells = map_of(recording)
    votes = sum_votes(collect_votes(recording, cfg, soft=True))
    share, hit, nearest, known = locate_gaps(votes, cfg)
    truth = true_cover(world, cfg.fine_m, share.shape)
    if not truth.any():
        raise InputError(recording.source, "world", "no oysters", "a reef with oysters")
    near_map = distance_to(cells.target, cells.cfg.cell_m) <= cfg.beside_m + 1e-6
    counted = fine_of(near_map, cells.cfg.cell_m, make_cover(votes, cfg))
    bins = bins_of(share, votes.nearest_m)

    def evidence(region: NDArray[np.bool_], shells: NDArray[np.float32]) -> AreaEvidence:
        inside = counted & region
        both = _count(bins[inside & hit]) + _count(bins.ravel()[nearest[inside & known]])
        return AreaEvidence(float(shells.sum(dtype=np.float64)) * cfg.fine_m**2, 0.5 * cfg.fine_m**2 * both)

    own = _nearest_cluster(world, cfg.fine_m, share.shape)
    away = cv2.distanceTransform((truth == 0.0).astype(np.uint8), cv2.DIST_L2, 5) * cfg.fine_m
    clusters = [
        evidence((own == k) & (away <= BESIDE_M), np.where(own == k, truth, np.float32(0.0)))
        for k in range(len(world.clusters))
    ]
    return ReefEvidence(
        name=recording.name,
        whole=evidence(np.ones(share.shape, np.bool_), truth),
        clusters=tuple(one for one in clusters if one.true_m2 > 0.0),
        hit=_count(bins[counted & hit]),
        shells=np.bincount(bins[counted & hit], weights=truth[counted & hit], minlength=BINS).astype(np.float64),
    )


def fit_cover(reefs: list[ReefEvidence]) -> NDArray[np.float64]:
    """Return the mean true cover of each bin, scaled so that areas are right on the whole. Shape=(BINS,).

    The scale, a few percent, is for what a survey misses and for what lies in gaps.
    """
    hit, shells = (np.sum([getattr(one, name) for one in reefs], axis=0) for name in ("hit", "shells"))
    cover = shells / np.maximum(hit, 1.0)
    found = sum(float(one.whole.cells_m2 @ cover) for one in reefs)
    return np.asarray(cover * sum(one.whole.true_m2 for one in reefs) / max(found, 1e-9))


def leave_one_out(reefs: list[ReefEvidence]) -> list[tuple[float, list[float]]]:
    """Return, for each reef, the relative errors of its area and of its clusters', calibrated on all others."""
    errors = []
    for number, left_out in enumerate(reefs):
        cover = fit_cover(reefs[:number] + reefs[number + 1 :])
        errors.append((left_out.whole.error(cover), [one.error(cover) for one in left_out.clusters]))
    return errors


def calibrate(reefs: list[ReefEvidence], made_by: str) -> CoverCalibration:
    """Fit a calibration, and measure the errors that it leaves on reefs that it was not fitted on.

    The squared relative error of an area A is modelled as common² + patch² / A: an equal share in all of a reef, and
    independent errors of its parts. Reefs and clusters, which are smaller, tell them apart.

    Raises:
        InputError: There are too few reefs.
    """
    if len(reefs) < LEAST_REEFS:
        raise InputError("--runs", "", f"{len(reefs)} reefs", f"at least {LEAST_REEFS}")
    errors = leave_one_out(reefs)
    large, small = _mean_square([whole for whole, _ in errors]), _mean_square([e for _, parts in errors for e in parts])
    reef_m2 = float(np.mean([one.whole.true_m2 for one in reefs]))
    cluster_m2 = float(np.mean([part.true_m2 for one in reefs for part in one.clusters]))
    patch = max(small - large, 0.0) / max(1.0 / cluster_m2 - 1.0 / reef_m2, 1e-9)
    patch = min(patch, large * reef_m2)
    return CoverCalibration(
        cover=tuple(fit_cover(reefs).tolist()),
        common=math.sqrt(max(large - patch / reef_m2, 0.0)),
        patch_m=math.sqrt(patch),
        reefs=len(reefs),
        made_by=made_by,
    )


def _mean_square(errors: list[float]) -> float:
    return float(np.mean(np.square(errors)))


def _count(bins: NDArray[np.intp]) -> NDArray[np.float64]:
    return np.bincount(bins.ravel(), minlength=BINS).astype(np.float64)


def _nearest_cluster(world: ReefWorld, fine_m: float, shape: tuple[int, int]) -> NDArray[np.intp]:
    """Return the cluster whose middle is nearest to each fine cell. Shape=(FY, FX)."""
    y, x = ((np.arange(end) + 0.5) * fine_m for end in shape)
    best, own = np.full(shape, np.inf), np.zeros(shape, np.intp)
    for number, cluster in enumerate(world.clusters):
        middle = np.mean([(one.x, one.y) for one in cluster.oysters], axis=0)
        away = (x[None, :] - middle[0]) ** 2 + (y[:, None] - middle[1]) ** 2
        own[away < best] = number
        np.minimum(best, away, out=best)
    return own
