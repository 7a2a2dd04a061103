"""Means and paired differences, with bootstrap intervals that account for the similarity of missions in one world."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

K = TypeVar("K", bound=Hashable)

FEW_WORLDS = 6
"""With fewer worlds a bootstrap has too few different samples: three worlds make ten."""
RESAMPLES = 4000
SEED = 20260314
"""Seed of the bootstrap: the same results give the same intervals."""


@dataclass(frozen=True)
class Estimate:
    """A mean over `count` episodes with its interval; `low` and `high` are nan for a single episode."""

    mean: float
    low: float
    high: float
    count: int

    @property
    def tells(self) -> bool:
        """Return whether the interval excludes zero."""
        return bool(self.low > 0.0 or self.high < 0.0)


def bootstrap_mean(values: Sequence[float], groups: Sequence[Hashable]) -> Estimate:
    """Compute mean and 95 % interval of the cluster bootstrap (Efron and Tibshirani 1993; Field and Welsh 2007).

    Whole groups are drawn with replacement: missions in the same world resemble each other, so drawing single missions
    would make the interval too narrow. With only one group, its values are drawn instead. Shape=(N,) of both.
    """
    data = np.asarray(values, np.float64)
    if len(data) == 0:
        return Estimate(np.nan, np.nan, np.nan, 0)
    names = {group: k for k, group in enumerate(dict.fromkeys(groups))}
    member = np.array([names[group] for group in groups])
    if len(names) == 1:
        member = np.arange(len(data))
    sums, counts = np.bincount(member, data), np.bincount(member).astype(np.float64)
    if len(sums) == 1:
        return Estimate(float(data.mean()), np.nan, np.nan, len(data))
    draws = np.random.default_rng(SEED).integers(0, len(sums), size=(RESAMPLES, len(sums)))
    means: NDArray[np.float64] = sums[draws].sum(axis=1) / counts[draws].sum(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return Estimate(float(data.mean()), float(low), float(high), len(data))


def paired_difference(ours: Mapping[K, float], reference: Mapping[K, float], group: Mapping[K, Hashable]) -> Estimate:
    """Compute the mean of `ours - reference` over the pairs that both have; a pair's group is such as its world."""
    keys = [key for key in ours if key in reference]
    return bootstrap_mean([ours[key] - reference[key] for key in keys], [group[key] for key in keys])


def wilson(won: int, trials: int, z: float = 1.96) -> tuple[float, float]:
    """Compute Wilson's score interval of a proportion (Wilson 1927): it keeps its level at 0/n, n/n and small n."""
    if not trials:
        return 0.0, 1.0
    share, spread = won / trials, z * z / trials
    middle = (share + spread / 2) / (1 + spread)
    half = z / (1 + spread) * math.sqrt(share * (1 - share) / trials + spread / (4 * trials))
    return max(0.0, middle - half), min(1.0, middle + half)


def sign_test(first: int, second: int) -> float:
    """Return the two-sided p value of these counts of pairs for the first and the second, if either were as likely."""
    pairs, fewer = first + second, min(first, second)
    return min(1.0, 2.0 * sum(math.comb(pairs, k) for k in range(fewer + 1)) / 2.0**pairs)
