import math

import numpy as np
import pytest

from coral.reef.sea.known_ground import BARE, OBSTACLE, OYSTER, KnownGround
from coral.reef.sea.local_frame import shift_points, turned_about
from coral.reef.sea.map_alignment import AlignmentCfg, align_maps
from coral.reef.sea.map_alignment_kernels import score_poses
from coral.reef.world.geometry import Pose

CELL, SIZE, START = 0.05, (240, 240), Pose(5.0, 6.0, 0.4)
"""A ground of 12 m by 12 m."""


def ground(bodies, seen=lambda x, y: np.ones_like(x, np.bool_), where=None):
    """A ground with round bodies (x, y, radius, kind), seen where `seen` says; `where` says what lies at each cell."""
    iy, ix = np.indices(SIZE)
    at = np.stack([(ix.ravel() + 0.5) * CELL, (iy.ravel() + 0.5) * CELL], axis=1)
    x, y = (at if where is None else where(at)).T
    masks = np.zeros((3, len(x)), np.bool_)
    for bx, by, radius, kind in bodies:
        masks[kind] |= np.hypot(x - bx, y - by) <= radius
    masks[OYSTER] &= ~masks[OBSTACLE]
    masks[BARE] = ~(masks[OBSTACLE] | masks[OYSTER])
    masks &= seen(x, y)
    return KnownGround(masks.reshape(3, *SIZE), CELL)


def moved(bodies, shift, seen):
    """What a dive sees of the same bodies whose stated frame becomes the saved one by `shift`."""
    return ground(bodies, seen, lambda at: shift_points(shift, at))


def scattered(seed, count=50):
    rng = np.random.default_rng(seed)
    return [
        (*rng.uniform(1.0, 11.0, 2).tolist(), float(rng.uniform(0.15, 0.35)), (OBSTACLE, OYSTER)[k % 2])
        for k in range(count)
    ]


def near_start(x, y):
    return np.hypot(x - START.x, y - START.y) < 4.0


@pytest.mark.parametrize(
    ("x", "y", "turn_deg"),
    [(0.0, 0.0, 0.0), (3.0, 0.0, 30.0), (-1.3, 2.6, -30.0), (0.4, -2.0, 17.3), (-2.1, -2.1, 8.0)],
)
def test_a_dive_up_to_3_m_and_30_degrees_off_finds_its_place(x, y, turn_deg):
    bodies, shift = scattered(3), turned_about(START, x, y, math.radians(turn_deg))
    found = align_maps(ground(bodies), moved(bodies, shift, near_start), START)
    assert not found.refusal
    truth, here = shift.to_survey(START), found.shift.to_survey(START)
    assert math.dist(here[:2], truth[:2]) < 0.06
    assert found.turned_deg == pytest.approx(turn_deg, abs=0.6)
    assert found.matched == found.bodies >= 12
    assert found.residual_m < 0.06
    assert f"{found.matched} of {found.bodies} bodies match" in str(found)


def test_bodies_in_equal_distances_are_ambiguous():
    grid = [(0.5 + i, 0.5 + j, 0.2, OBSTACLE) for i in range(12) for j in range(12)]
    shift = turned_about(START, 0.3, 0.2, 0.0)
    found = align_maps(ground(grid), moved(grid, shift, near_start), START)
    assert found.refusal.startswith("ambiguous: a place 1")


def test_few_bodies_are_too_little():
    bodies = scattered(3, 3)
    found = align_maps(ground(bodies), moved(bodies, turned_about(START, 0.5, 0.5, 0.0), near_start), START)
    assert found.refusal.startswith("too little to compare")


@pytest.mark.parametrize("empty", ["saved", "new", "both"])
def test_nothing_seen_is_too_little(empty):
    nothing = KnownGround(np.zeros((3, *SIZE), np.bool_), CELL)
    known = ground(scattered(3))
    found = align_maps(nothing if empty != "new" else known, nothing if empty != "saved" else known, START)
    assert found.refusal.startswith("too little to compare")
    assert math.isnan(found.residual_m)


@pytest.mark.parametrize("seed", range(4))
def test_another_reef_is_refused(seed):
    saved, other = ground(scattered(seed)), scattered(seed + 100)
    assert align_maps(saved, ground(other, near_start), START).refusal


def test_a_start_beyond_the_search_is_refused():
    bodies, shift = scattered(3), turned_about(START, 3.0, 0.0, 0.0)
    found = align_maps(ground(bodies), moved(bodies, shift, near_start), START, AlignmentCfg(shift_m=2.0))
    assert found.refusal


def test_the_kernel_adds_up_what_numpy_does():
    rng = np.random.default_rng(0)
    poses, points = rng.uniform(-1, 1, (50, 3)), rng.uniform(0.0, 5.0, (30, 2))
    kinds, fields = rng.integers(0, 3, 30), rng.normal(size=(3, 80, 90)).astype(np.float32)
    scores = np.empty(50)
    score_poses(poses, points, kinds, (2.0, 2.5), fields, CELL, scores)
    expected = []
    for x, y, turn in poses:
        placed = shift_points(turned_about(Pose(2.0, 2.5, 0.0), x, y, turn), points)
        ix, iy = np.floor(placed / CELL).astype(int).T
        inside = (ix >= 0) & (iy >= 0) & (ix < 90) & (iy < 80)
        expected.append(float(fields[kinds[inside], iy[inside], ix[inside]].sum(dtype=float)))
    assert scores == pytest.approx(expected, abs=1e-6)
