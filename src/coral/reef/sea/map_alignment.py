"""Alignment of two maps of one area: where a new dive's map lies on the map of an earlier one.

A search over shift and turn about a stated start (correlative scan matching, Olson 2009), with a check that no other
place fits nearly as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Fraction, Positive
from coral.reef.sea.known_ground import BARE, KINDS, KnownGround
from coral.reef.sea.local_frame import LocalFrame, shift_points, turned_about
from coral.reef.sea.map_alignment_kernels import score_poses
from coral.reef.world.geometry import Pose

WIDER = 2.5
"""The first search blurs the saved map by so much more, so that no peak lies between its steps."""
PEAKS = 12
"""Places of the first search that are looked at closely."""
Steps = tuple[float, float]
"""How far a search reaches either way, and its step."""


@dataclass(frozen=True, kw_only=True)
class AlignmentCfg:
    """How far a resumed survey may be off its stated start, and how sure an alignment must be."""

    shift_m: Positive = 3.5
    """The vehicle is at most this far from the stated start along each axis (m)."""
    turn_deg: Positive = 35.0
    """Its heading is at most this far from the stated one."""
    sigma_m: Positive = 0.12
    """How far the outline of a body differs between two dives (m): two cells, since it was seen from other sides."""
    hit: Fraction = 0.8
    """Share of the points that show again what the earlier dive has seen; the others moved, grew or were seen wrong."""
    least_bodies: Count = 12
    """Obstacles and oyster clusters that both maps must show. A dive that meets the bodies from behind sees their other
    sides: it was off by up to 0.24 m and 2.5° with 7 to 12 bodies, by up to 0.12 m and 1° with 14 or more."""
    matched: Fraction = 0.75
    """Share of the comparable ones that must lie on one of the same kind. Right alignments on s1, l2 and o1 had all; of
    54 with the map of another reef, or more than 5 m off, six had more than half, one of them 3 of 4."""
    same_m: Positive = 0.3
    """A body's cells lie on it if they are this near (m)."""
    apart_m: Positive = 0.7
    """A second place is one that moves the middle of the new map's bodies by more than this (m), ..."""
    apart_deg: Positive = 10.0
    """... or turned by more than this."""
    margin: Fraction = 0.25
    """The second place's score must be smaller than the best one's by this share."""
    least_score: Positive = 500.0
    """Least logarithm of the likelihood of the alignment over that of a random one."""


@dataclass(frozen=True, kw_only=True)
class MapAlignment:
    """The best place of the new map, with the evidence for it."""

    shift: LocalFrame
    """From the stated frame to that of the earlier map."""
    moved_m: float
    """How far the stated start was off (m)."""
    turned_deg: float
    """How far the stated heading was off."""
    score: float
    """Logarithm of the likelihood over that of a random place."""
    second: float
    """The same of the best place that is another one."""
    second_m: float
    """How far apart the two put the middle of the new map's bodies (m)."""
    bodies: int
    """Obstacles and oyster clusters of the new map that lie where the earlier map has been seen."""
    matched: int
    """Those that lie on one of the same kind."""
    residual_m: float
    """Root mean square distance of the matched ones' cells from the earlier map's; nan without any."""
    refusal: str = ""
    """Why it must not be used, or ""."""

    def __str__(self) -> str:
        second = f"{self.second:.0f}, {self.second_m:.1f} m away" if self.second > 0.0 else "none"
        return (
            f"the start is {self.moved_m:.2f} m and {self.turned_deg:+.1f}° off; {self.matched} of {self.bodies} "
            f"bodies match, residual {self.residual_m:.2f} m, score {self.score:.0f}, second best {second}"
        )


def align_maps(saved: KnownGround, new: KnownGround, start: Pose, cfg: AlignmentCfg | None = None) -> MapAlignment:
    """Find where a new map lies on a saved one.

    Args:
        saved: The earlier map, in its frame.
        new: The map since the vehicle was put in, in the frame in which it began at `start`.
        start: Where the operator said that it was put in: the pivot of the search.
        cfg: Range of the search, and what is asked of the result.

    Returns:
        The best place; `refusal` says whether and why it must not be used.
    """
    cfg = cfg or AlignmentCfg()
    points, kinds = new.points()
    pivot = (start.x, start.y)

    def score(poses: NDArray[np.float64], fields: NDArray[np.float32]) -> NDArray[np.float64]:
        scores = np.empty(len(poses))
        score_poses(poses, points, kinds, pivot, fields, saved.cell_m, scores)
        return scores

    def refine(pose: NDArray[np.float64], shift: Steps, turn: Steps) -> tuple[NDArray[np.float64], float]:
        poses = pose + _grid(shift, turn)
        scores = score(poses, fields)
        best = int(np.argmax(scores))
        return poses[best], float(scores[best])

    bodies = points[kinds != BARE]
    arm = bodies.mean(axis=0) - pivot if len(bodies) else np.zeros(2)
    coarse = _grid((cfg.shift_m, 0.2), (math.radians(cfg.turn_deg), math.radians(3.0)))
    peaks = _peaks(coarse, score(coarse, _fields(saved, WIDER * cfg.sigma_m, cfg.hit)), arm, cfg)
    fields = _fields(saved, cfg.sigma_m, cfg.hit)
    found = [refine(pose, (0.2, 0.05), (math.radians(3.0), math.radians(0.5))) for pose in peaks]
    found.sort(key=lambda each: -each[1])
    best = refine(found[0][0], (0.05, 0.01), (math.radians(0.5), math.radians(0.1)))
    second = next((each for each in found[1:] if _differ(each[0][None], best[0], arm, cfg)[0]), (best[0], 0.0))
    away_m = math.dist(_middles(second[0][None], arm)[0], _middles(best[0][None], arm)[0])
    return _judged(saved, new, best, (away_m, second[1]), start, cfg)


def _judged(
    saved: KnownGround,
    new: KnownGround,
    best: tuple[NDArray[np.float64], float],
    second: tuple[float, float],
    start: Pose,
    cfg: AlignmentCfg,
) -> MapAlignment:
    """Compare the bodies of both maps under a pose, and say what speaks against it."""
    x, y, turn = best[0].tolist()
    shift = turned_about(start, x, y, turn)
    distances = [_distance(saved.masks[kind], saved.cell_m) for kind in KINDS]
    seen = saved.seen
    squares: list[NDArray[np.float64]] = []
    bodies = matched = 0
    ny, nx = seen.shape
    for kind, cells in new.bodies():
        placed = shift_points(shift, cells)
        index = np.floor(placed / saved.cell_m).astype(np.intp)
        inside = (index >= 0).all(axis=1) & (index[:, 0] < nx) & (index[:, 1] < ny)
        index = index[inside]
        index = index[seen[index[:, 1], index[:, 0]]]
        if 2 * len(index) < len(cells):
            continue
        bodies += 1
        away = distances[kind][index[:, 1], index[:, 0]]
        near = away <= cfg.same_m
        if near.mean() >= 0.5:
            matched += 1
            squares.append(away[near] ** 2)
    residual = math.sqrt(float(np.concatenate(squares).mean())) if squares else math.nan
    found = MapAlignment(
        shift=shift,
        moved_m=math.hypot(x, y),
        turned_deg=math.degrees(turn),
        score=best[1],
        second=second[1],
        second_m=second[0],
        bodies=bodies,
        matched=matched,
        residual_m=residual,
    )
    edge = max(abs(x), abs(y)) > cfg.shift_m - 0.1 or abs(turn) > math.radians(cfg.turn_deg - 1.5)
    return replace(found, refusal=_refusal(found, cfg, at_edge=edge))


def _refusal(found: MapAlignment, cfg: AlignmentCfg, *, at_edge: bool) -> str:
    bodies, matched, score, second = found.bodies, found.matched, found.score, found.second
    if bodies < cfg.least_bodies:
        return f"too little to compare: {bodies} bodies lie where the saved map was seen, {cfg.least_bodies} are needed"
    if matched < cfg.least_bodies or matched < cfg.matched * bodies or score < cfg.least_score:
        return f"no match: {matched} of {bodies} bodies lie on one of the saved map, score {score:.0f}"
    if second > (1.0 - cfg.margin) * score:
        away = f"{found.second_m:.1f} m away"
        return f"ambiguous: a place {away} fits nearly as well, score {second:.0f} against {score:.0f}"
    if at_edge:
        return f"the best place lies at the edge of the search, {cfg.shift_m:g} m and {cfg.turn_deg:g}° about the start"
    return ""


def _grid(shift: Steps, turn: Steps) -> NDArray[np.float64]:
    """Return all poses within reach: shift along x and y (m), turn (rad). Shape=(K, 3)."""
    (reach, step), (turn_reach, turn_step) = shift, turn
    n, m = round(reach / step), round(turn_reach / turn_step)
    steps, turns = np.arange(-n, n + 1) * step, np.arange(-m, m + 1) * turn_step
    return np.stack(np.meshgrid(steps, steps, turns, indexing="ij"), axis=-1).reshape(-1, 3)


def _fields(saved: KnownGround, sigma_m: float, hit: float) -> NDArray[np.float32]:
    """Return the logarithm of the likelihood of a point of each kind in each cell, over that in a random seen cell.

    The likelihood is `hit * g / mean(g) + 1 - hit` with g = exp(-d² / 2 sigma²) for the distance d to the kind: its
    mean over the seen cells is 1. So rare kinds count more than bare seabed. Where nothing was seen it is 1.
    """
    seen = saved.seen
    fields = np.zeros(saved.masks.shape, np.float32)
    for kind in KINDS:
        if not saved.masks[kind].any():
            continue
        near = np.exp(-0.5 * (_distance(saved.masks[kind], saved.cell_m) / sigma_m) ** 2)
        fields[kind][seen] = np.log(hit * near[seen] / near[seen].mean() + 1.0 - hit)
    return fields


def _distance(mask: NDArray[np.bool_], cell_m: float) -> NDArray[np.float32]:
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5) * cell_m, np.float32)


def _middles(poses: NDArray[np.float64], arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where poses move the middle of the new map's bodies to, from the pivot (m). Shape=(K, 2).

    Args:
        poses: Shape=(K, 3).
        arm: Where the middle is at the pose zero. Shape=(2,).
    """
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.asarray(poses[:, :2] + np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1))


def _peaks(
    poses: NDArray[np.float64], scores: NDArray[np.float64], arm: NDArray[np.float64], cfg: AlignmentCfg
) -> list[NDArray[np.float64]]:
    """Return the best poses that are different places, best first."""
    found: list[NDArray[np.float64]] = []
    left = scores.copy()
    while len(found) < PEAKS and np.isfinite(left).any():
        best = int(np.argmax(left))
        found.append(poses[best])
        left[~_differ(poses, poses[best], arm, cfg)] = -np.inf
    return found


def _differ(
    poses: NDArray[np.float64], pose: NDArray[np.float64], arm: NDArray[np.float64], cfg: AlignmentCfg
) -> NDArray[np.bool_]:
    """Check which poses are other places than one of them. Shape=(K,)."""
    away = np.hypot(*(_middles(poses, arm) - _middles(pose[None], arm)).T)
    turned = np.abs(poses[:, 2] - pose[2])
    return np.asarray((away >= cfg.apart_m) | (turned >= math.radians(cfg.apart_deg)))
