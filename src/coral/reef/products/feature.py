"""Features: geometries with attributes, as layers of a map."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

GeometryKind = Literal["Point", "LineString", "MultiPolygon"]
Value = float | int | str | None


@dataclass(frozen=True)
class Feature:
    """One thing on a map."""

    rings: tuple[NDArray[np.float64], ...]
    """A point or a line, or the closed outlines of a multipolygon's parts, in metres. Shape=(N, 2) each."""
    values: dict[str, Value]


@dataclass(frozen=True)
class Layer:
    """Features of one kind, all with the same attributes."""

    name: str
    kind: GeometryKind
    features: tuple[Feature, ...]
    title: str = ""
    columns: tuple[str, ...] = field(default=())
    """Names of the attributes, for a layer that may have no features."""

    @property
    def attributes(self) -> tuple[str, ...]:
        """Names of the attributes."""
        return tuple(self.features[0].values) if self.features else self.columns


def closed_ring(ring: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a polygon's outline closed and counter-clockwise, as RFC 7946 wants outer rings. Shape=(N, 2)."""
    if not np.array_equal(ring[0], ring[-1]):
        ring = np.concatenate([ring, ring[:1]])
    x, y = ring[:, 0], ring[:, 1]
    area = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return ring if area >= 0.0 else ring[::-1].copy()
