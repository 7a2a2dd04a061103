"""The centroid chain: oyster clusters as a short, ordered list of stable, labelled points (paper III-B)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, Positive


@dataclass(frozen=True, kw_only=True)
class InspectCfg:
    """When a cluster counts as done: by what was seen of it from near, not by where the robot has been."""

    enabled: bool = True
    """Whether a cluster is done by what was seen of it. Departs from the paper: there it is visited once the robot has
    been near its centroid, whatever it saw (False)."""
    pixel_m: Positive = 0.05
    """Largest pixel at which oysters can be counted (see `ImagingCfg.pixel_m`); with the default camera 2.3 m away."""
    share: Fraction = 0.95
    """Share of a cluster's cells that must have been seen from there; the rest is edges that no pixel hit."""
    least_m2: float = 0.04
    """Less than this is not worth a visit: a few oysters."""
    confirmed: Fraction = 0.1
    """Where eyes doubt, a cluster is none if no more than this share of it was seen from near, from beside it."""
    sure: Fraction = 0.33
    """A cluster is doubtful while the pictures agree less than this that oysters lie in its cells
    (`OccupancyMap.agreement`). Along one mission on s1 in `hard` water, with 1, 3 and 6 % of the seabed taken for
    oysters, true clusters had 0.54, 0.53 and 0.35 or more in 99 of 100 updates, false ones at most 0.31."""


@dataclass(frozen=True, kw_only=True)
class ChainCfg:
    """Component filter and centroid tracking."""

    min_area_px: int = 100
    """A_min (paper IV-F)."""
    closing_m: float = 0.35
    """Gaps between oysters up to this wide are closed before components are labelled. Departs from the paper: at 0.05 m
    one oyster is about 12 cells, so a bed of separate oysters would never reach A_min."""
    merge_distance_m: float = 1.0
    """d_merge; not given in the paper. Equal to its minimum target separation."""
    alpha_new: float = 0.3
    """Weight of the new centroid in Eq. 3 (alpha_old = 1 - alpha_new); not given in the paper."""
    far_merge_m: float = 2.5
    """What is seen from afar may lie this far from where it turns out to be."""
    drop_after: int = 30
    """Consecutive unmatched updates after which a track is removed; not given in the paper."""


def _no_cells() -> NDArray[np.intp]:
    return np.empty((0, 2), np.intp)


def _no_points() -> NDArray[np.float64]:
    return np.empty((0, 2))


@dataclass(frozen=True, kw_only=True)
class Component:
    """One connected oyster region."""

    x: float
    y: float
    """Centroid in the world (m), Eq. 2."""
    area_px: int
    length_m: float
    """Longer edge of its bounding box (m); tells strips from compact clusters."""
    cells: NDArray[np.intp] = field(default_factory=_no_cells, repr=False, compare=False)
    """Its oyster cells (iy, ix). Shape=(M, 2)."""


@dataclass(frozen=True, kw_only=True)
class Track:
    """A cluster as the advisor knows it: `index` is its label throughout its life."""

    index: int
    x: float
    y: float
    area_px: int
    length_m: float
    unmatched: int = 0
    visited: bool = False
    far: bool = False
    """Seen from afar only, beyond the map's range; a cluster that the map then shows there keeps the label."""
    inspected: float = 0.0
    """Share of its cells that were seen from near enough to count oysters."""
    doubtful: bool = False
    """Most pictures show seabed where this cluster should be. Looks on the way will confirm or outvote it."""
    cells: NDArray[np.intp] = field(default_factory=_no_cells, repr=False, compare=False)
    """Its oyster cells (iy, ix). Shape=(M, 2)."""
    left: NDArray[np.float64] = field(default_factory=_no_points, repr=False, compare=False)
    """Centres of its cells that are still to be seen from near. Shape=(L, 2), metres."""


def components(target: NDArray[np.bool_], cell_m: float, cfg: ChainCfg) -> list[Component]:
    """Find the connected oyster regions of at least A_min, with their centroids (Eq. 2), from the lowest row up.

    `target` has Shape=(NY, NX).
    """
    rows, columns = np.flatnonzero(target.any(axis=1)), np.flatnonzero(target.any(axis=0))
    if not rows.size:
        return []
    width = closing_width(cell_m, cfg)
    y0, x0 = max(int(rows[0]) - width, 0), max(int(columns[0]) - width, 0)
    part = target[y0 : int(rows[-1]) + 1 + width, x0 : int(columns[-1]) + 1 + width]
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
    closed = cv2.morphologyEx(part.astype(np.uint8), cv2.MORPH_CLOSE, kernel)
    count, labels, stats, centroids = cv2.connectedComponentsWithStats(closed, connectivity=8)
    iy, ix = np.nonzero(part)
    of = labels[iy, ix]
    order = np.argsort(of, kind="stable")
    cells = np.stack([iy + y0, ix + x0], axis=1)[order]
    ends = np.searchsorted(of[order], np.arange(count + 1))
    left, top, wide, high, area = (stats[:, k].tolist() for k in range(5))
    return [
        Component(
            x=float((centroids[k, 0] + x0 + 0.5) * cell_m),
            y=float((centroids[k, 1] + y0 + 0.5) * cell_m),
            area_px=area[k],
            length_m=float(max(wide[k], high[k]) * cell_m),
            cells=cells[ends[k] : ends[k + 1]],
        )
        for k in sorted(range(1, count), key=lambda k: (top[k], left[k]))
        if area[k] >= cfg.min_area_px
    ]


def closing_width(cell_m: float, cfg: ChainCfg) -> int:
    """Return the width (cells) of the structuring element that closes gaps between oysters."""
    return max(1, round(cfg.closing_m / cell_m)) | 1


def order_chain(points: NDArray[np.float64]) -> list[int]:
    """Order points, Shape=(K, 2), into one path that follows their spine (paper III-B, "path ordering").

    Path segments grow greedily: the closest pair of segment ends that belong to different segments (union-find)
    is joined until one path is left. Returns indices, from one end of the path to the other.
    """
    k = len(points)
    if k < 2:
        return list(range(k))
    parent = list(range(k))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    links: list[list[int]] = [[] for _ in range(k)]
    first, second = np.triu_indices(k, 1)
    gaps = np.linalg.norm(points[first] - points[second], axis=1)
    for pair in np.argsort(gaps, kind="stable"):
        i, j = int(first[pair]), int(second[pair])
        if len(links[i]) < 2 and len(links[j]) < 2 and root(i) != root(j):
            parent[root(i)] = root(j)
            links[i].append(j)
            links[j].append(i)
    chain = [next(i for i in range(k) if len(links[i]) == 1)]
    while len(chain) < k:
        chain.append(next(j for j in links[chain[-1]] if len(chain) < 2 or j != chain[-2]))
    return chain


def spanning_tree(points: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Return the K - 1 shortest links that join all points, Shape=(K, 2): the chain with its forks (Prim 1957)."""
    k = len(points)
    if k < 2:
        return []
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    nearest, joined, links = gaps[0].copy(), np.zeros(k, np.int64), []
    nearest[0] = np.inf
    for _ in range(k - 1):
        new = int(np.argmin(nearest))
        links.append((int(joined[new]), new))
        nearest[new] = np.inf
        closer = (gaps[new] < nearest) & np.isfinite(nearest)
        nearest[closer], joined[closer] = gaps[new][closer], new
    return links


class CentroidTracker:
    """Keeps labels stable while the map grows: nearest match within d_merge, Eq. 3 smoothing, expiry."""

    def __init__(self, cfg: ChainCfg | None = None) -> None:
        self.cfg = cfg or ChainCfg()
        self.tracks: list[Track] = []
        """Replaced as a whole, so that a shallow copy stays as it is."""
        self._labels = itertools.count()
        """A label means one cluster throughout a mission."""

    def recall(self, tracks: Sequence[Track]) -> None:
        """Take over tracks of an earlier survey, with their labels; new ones get labels above them."""
        self.tracks = list(tracks)
        self._labels = itertools.count(1 + max((track.index for track in tracks), default=-1))

    def settle(self) -> None:
        """Drop, at the end of a survey, the tracks that the map no longer shows and that are kept for a while."""
        self.tracks = [t for t in self.tracks if not t.unmatched]

    def update(self, found: Sequence[Component], hints: Sequence[tuple[float, float]] = ()) -> list[Track]:
        """Match components to tracks, closest pairs first, each at most once; start and drop tracks.

        Hints, places (m) of oysters seen beyond the map's range, are tracks of their own until the map shows them.
        """
        cfg = self.cfg
        tracks = [t for t in self.tracks if not t.far]
        afar = [t for t in self.tracks if t.far]
        apart = np.hypot(
            np.subtract.outer([c.x for c in found], [t.x for t in tracks]),
            np.subtract.outer([c.y for c in found], [t.y for t in tracks]),
        ).reshape(len(found), len(tracks))
        near = np.argwhere(apart <= cfg.merge_distance_m)
        match: dict[int, int] = {}
        for k in np.argsort(apart[near[:, 0], near[:, 1]], kind="stable"):
            i, j = near[k].tolist()
            if i not in match and j not in match.values():
                match[i] = j
        kept: dict[int, Track] = {}
        for i, j in match.items():
            c, t, a = found[i], tracks[j], cfg.alpha_new
            kept[j] = replace(
                t,
                x=(1 - a) * t.x + a * c.x,
                y=(1 - a) * t.y + a * c.y,
                area_px=c.area_px,
                length_m=c.length_m,
                cells=c.cells,
                unmatched=0,
            )
        for j, t in enumerate(tracks):
            if j not in kept and t.unmatched + 1 < cfg.drop_after:
                kept[j] = replace(t, unmatched=t.unmatched + 1, cells=_no_cells(), left=_no_points())
        survivors = [kept[j] for j in sorted(kept)]
        for i, c in enumerate(found):
            if i not in match:
                old = nearest_track(afar, c.x, c.y, cfg.far_merge_m)
                afar = [t for t in afar if t is not old]
                label = next(self._labels) if old is None else old.index
                survivors.append(
                    Track(index=label, x=c.x, y=c.y, area_px=c.area_px, length_m=c.length_m, cells=c.cells)
                )
        survivors += self._afar(afar, hints, survivors)
        self.tracks = survivors
        return survivors

    def _afar(self, afar: Sequence[Track], hints: Sequence[tuple[float, float]], near: Sequence[Track]) -> list[Track]:
        """Update the tracks of what was seen from afar; one without a hint is dropped: the robot has looked there."""
        tracks: list[Track] = []
        rest = list(afar)
        for x, y in hints:
            if nearest_track([*near, *tracks], x, y, self.cfg.far_merge_m) is not None:
                continue  # known, or the same cluster seen from elsewhere
            old = nearest_track(rest, x, y, self.cfg.far_merge_m)
            rest = [t for t in rest if t is not old]
            label = next(self._labels) if old is None else old.index
            left = np.array([[x, y]])
            tracks.append(Track(index=label, x=x, y=y, area_px=0, length_m=0.0, far=True, left=left))
        return tracks

    def inspect(
        self,
        nearest: NDArray[np.float32],
        unseeable: NDArray[np.bool_],
        near_m: float,
        cell_m: float,
        cfg: InspectCfg,
    ) -> None:
        """Update how much of each cluster has been seen from near, and mark as visited where next to nothing is left.

        `nearest`, Shape=(NY, NX), is the smallest distance (m) from which each cell has been seen. From `near_m` on
        oysters can be counted. Cells that are `unseeable`, Shape=(NY, NX), are not worth another try.
        """
        tracks = []
        for track in self.tracks:
            if track.far:
                tracks.append(track)
                continue
            iy, ix = track.cells[:, 0], track.cells[:, 1]
            far = nearest[iy, ix] > near_m
            left = track.cells[far & ~unseeable[iy, ix]]
            share = 1.0 - float(far.mean()) if len(far) else track.inspected
            least = max(cfg.least_m2 / cell_m**2, (1.0 - cfg.share) * len(far))
            points = np.asarray((left[:, ::-1] + 0.5) * cell_m, np.float64)
            tracks.append(replace(track, inspected=share, left=points, visited=len(left) <= least))
        self.tracks = tracks

    def doubt(self, agreement: Callable[[NDArray[np.intp]], float], sure: float) -> None:
        """Mark the clusters of which the pictures agree, from 0 to 1, less than `sure` that there are oysters."""
        self.tracks = [
            replace(t, doubtful=agreement(t.cells) < sure) if len(t.cells) and not t.far else t for t in self.tracks
        ]

    def mark_visited(self, x: float, y: float, radius_m: float) -> None:
        """Mark the tracks that the vehicle has come within `radius_m` of as visited."""
        self.tracks = [
            t if t.visited or t.far or np.hypot(t.x - x, t.y - y) > radius_m else replace(t, visited=True)
            for t in self.tracks
        ]

    def chain(self) -> list[Track]:
        """Return the tracks in chain order, starting from the end that holds the lowest label."""
        tracks = self.tracks
        order = order_chain(np.array([[t.x, t.y] for t in tracks]).reshape(-1, 2))
        if order and tracks[order[-1]].index < tracks[order[0]].index:
            order.reverse()
        return [tracks[i] for i in order]


def nearest_track(tracks: Sequence[Track], x: float, y: float, within_m: float) -> Track | None:
    """Return the nearest track within a distance (m) of a point."""
    near = [(float(np.hypot(t.x - x, t.y - y)), t.index, t) for t in tracks]
    return min((n for n in near if n[0] <= within_m), default=(0.0, 0, None), key=lambda n: n[:2])[2]
