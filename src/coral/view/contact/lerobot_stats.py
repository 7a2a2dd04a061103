"""Statistics of a LeRobot data set: what its policies normalise by, exact for columns and for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.drawing import Image

QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def column_stats(values: Sequence[Any]) -> dict[str, list[float]]:
    """Compute the statistics of a column, Shape=(N,) or (N, D), one value for each of its numbers."""
    rows = np.asarray(values, np.float64).reshape(len(values), -1)
    found = {"min": rows.min(axis=0), "max": rows.max(axis=0), "mean": rows.mean(axis=0), "std": rows.std(axis=0)}
    found |= {name: np.quantile(rows, share, axis=0) for name, share in QUANTILES.items()}
    return {**{name: each.tolist() for name, each in found.items()}, "count": [len(rows)]}


class PictureStats:
    """Counts how often each brightness occurs in each channel, so that the statistics need no picture twice."""

    def __init__(self) -> None:
        self._counts = np.zeros((3, 256), np.int64)
        self._pictures = 0

    def add(self, picture: Image) -> None:
        """Count the pixels of a picture, Shape=(H, W, 3)."""
        self._counts += [np.bincount(picture[..., channel].ravel(), minlength=256) for channel in range(3)]
        self._pictures += 1

    def stats(self) -> dict[str, Any]:
        """Return the statistics by channel, Shape=(3, 1, 1), of brightness from 0 to 1; the count is in pictures."""
        levels = np.arange(256) / 255
        share = self._counts / self._counts.sum(axis=1, keepdims=True)
        below = np.cumsum(share, axis=1)
        mean = share @ levels
        found = {
            "min": [levels[np.flatnonzero(row)[0]] for row in self._counts],
            "max": [levels[np.flatnonzero(row)[-1]] for row in self._counts],
            "mean": mean,
            "std": np.sqrt(np.maximum(share @ levels**2 - mean**2, 0.0)),
        }
        found |= {
            name: [levels[min(int(np.searchsorted(row, at - 1e-12)), 255)] for row in below]
            for name, at in QUANTILES.items()
        }
        return {name: np.reshape(each, (3, 1, 1)).tolist() for name, each in found.items()} | {
            "count": [self._pictures]
        }
