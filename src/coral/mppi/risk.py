"""Risk: one cost of a control sequence from its costs under several beliefs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RiskCfg:
    """Risk measure over several beliefs."""

    measure: Literal["mean", "worst", "cvar"] = "mean"
    """"mean"; "worst"; "cvar", the mean of the worst share."""
    share: Fraction = 0.5
    """Share of the beliefs in "cvar"."""


def risk(costs: Array, cfg: RiskCfg) -> Array:
    """Compute the risk of each sequence, Shape=(K,), from its costs under each belief, Shape=(beliefs, K)."""
    if cfg.measure == "mean":
        return np.asarray(costs.mean(axis=0))
    if cfg.measure == "worst":
        return np.asarray(costs.max(axis=0))
    tail = max(1, int(np.ceil(cfg.share * costs.shape[0] - 1e-9)))
    return np.asarray(np.sort(costs, axis=0)[-tail:].mean(axis=0))
